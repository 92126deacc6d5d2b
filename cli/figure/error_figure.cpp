// SPDX-License-Identifier: Apache-2.0
#include "cli/figure/error_figure.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::cli {
namespace {

constexpr double kMillimetres = 1e3, kKilobits = 8e-3, kDegrees = 180 / std::numbers::pi;

/// [mm] of the vertex that is farthest off.   in  shown(v)  [m]
template <class Shown>
double largest_error(const std::vector<float>& truth, const Shown& shown) {
  double most = 0;
  for (std::size_t v = 0; 3 * v + 2 < truth.size(); ++v)
    most = std::max(most, norm(Vec3{truth[3 * v], truth[3 * v + 1], truth[3 * v + 2]} - shown(v)));
  return kMillimetres * most;
}

}  // namespace

ErrorFigure::ErrorFigure(const TraceInfo& info) : info_(info), meshes_(info.meshes.size()) {
  for (std::size_t i = 0; i < info.objects.size(); ++i)
    if (info.objects[i].dof != Dof::none) moving_.push_back(i);
}

void ErrorFigure::add(const TraceFrame& truth, std::span<const Pose> shown) {
  const double time = end_ = time_of(truth.tick);
  double position = 0, rotation = 0;
  for (const std::size_t i : moving_) {
    const Pose& pose = truth.objects[i].pose;
    position = std::max(position, norm(pose.position - shown[i].position));
    rotation = std::max(rotation, angle_between(pose.rotation, shown[i].rotation));
  }
  if (!moving_.empty()) {
    position_.add(time, kMillimetres * position);
    rotation_.add(time, kDegrees * rotation);
  }
  add_forces(truth, shown, time);
}

void ErrorFigure::add_forces(const TraceFrame& truth, std::span<const Pose> shown, double time) {
  double force = 0, error = 0;
  for (const UserSample& user : truth.users) {
    const Contact& contact = user.contact;
    if (contact.kind == ContactKind::none) continue;
    const Vec3 f = contact_force(contact, truth.objects[contact.object].pose);
    force = std::max(force, norm(f));
    error = std::max(error, norm(contact_force(contact, shown[contact.object]) - f));
    touches_ = true;
  }
  force_.add(time, force);
  force_error_.add(time, error);
}

void ErrorFigure::add_shape(const TraceFrame& truth, std::size_t mesh, std::span<const float> shown) {
  meshes_[mesh].add(time_of(truth.tick), largest_error(truth.meshes[mesh].displacements, [&](std::size_t v) {
                      return Vec3{shown[3 * v], shown[3 * v + 1], shown[3 * v + 2]};
                    }));
}

void ErrorFigure::add_shape(const TraceFrame& truth, std::size_t mesh, std::span<const std::array<std::int32_t, 3>> shown,
                            unsigned position_exp) {
  const double unit = std::ldexp(1.0, -static_cast<int>(position_exp));
  meshes_[mesh].add(
      time_of(truth.tick), largest_error(truth.meshes[mesh].displacements, [&](std::size_t v) {
        return unit * Vec3{static_cast<double>(shown[v][0]), static_cast<double>(shown[v][1]), static_cast<double>(shown[v][2])};
      }));
}

void ErrorFigure::add_packet(std::int64_t tick, const std::string& line, std::size_t bytes) {
  packets_[line].add(time_of(tick));
  bytes_.add(time_of(tick), kKilobits * static_cast<double>(bytes));
}

/// Of several users the largest force and the largest error are shown, which need not be of the same one: then there is no bound.
void ErrorFigure::add_force_panels(const Report& report, std::vector<Panel>& out) const {
  out.push_back({"contact force [N]", {{"force", force_.points()}}});
  Panel& errors = out.emplace_back(Panel{"force error [N]", {{"error", force_error_.points()}}});
  const RigidTriggers& bounds = report.fidelity->bounds();
  if (info_.users.size() > 1 || bounds.haptic != HapticRule::isotropic) return;
  Panel::Line& bound = errors.lines.emplace_back(Panel::Line{"bound", force_.points()});
  for (auto& point : bound.points) point[1] = point[1] > 0 ? bounds.weber_fraction * std::max(point[1], bounds.force_floor) : 0;
}

std::vector<Panel> ErrorFigure::panels(const Report& report) const {
  std::vector<Panel> out;
  const double width = width_of_rates(end_);
  if (!bytes_.is_empty()) {
    Panel& packets = out.emplace_back(Panel{"packets per second"});
    for (const auto& [name, line] : packets_) packets.lines.push_back({name, line.points(width, end_)});
    out.push_back({"payload [kbit/s]", {{"payload", bytes_.points(width, end_)}}});
  }
  if (!position_.is_empty() && report.fidelity) {
    const RigidTriggers& bounds = report.fidelity->bounds();
    out.push_back({"position error [mm]", {{"error", position_.points()}}, kMillimetres * bounds.visual_position});
    out.push_back({"rotation error [°]", {{"error", rotation_.points()}}, kDegrees * bounds.visual_rotation});
  }
  if (touches_ && report.fidelity) add_force_panels(report, out);
  for (std::size_t i = 0; i < meshes_.size(); ++i) {
    if (meshes_[i].is_empty()) continue;
    const double bound = kMillimetres * report.meshes[i].fidelity->bounds().visual;
    const std::string whose = meshes_.size() > 1 ? info_.meshes[i].name + ": " : "";
    out.push_back({whose + "largest error [mm]", {{"error", meshes_[i].points()}}, bound});
  }
  return out;
}

}  // namespace tactus::cli
