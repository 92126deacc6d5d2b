// SPDX-License-Identifier: Apache-2.0
#include "cli/figure/motion_figure.h"

#include <algorithm>
#include <utility>

namespace tactus::cli {
namespace {

constexpr double kMillimetres = 1e3, kKilobits = 8e-3;
constexpr std::size_t kMostObjects = 6;  // with panels and lines of their own
constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};

std::array<double, 3> components(const Vec3& v) { return {v.x, v.y, v.z}; }

double largest(const std::vector<float>& u) {
  double most = 0;
  for (std::size_t i = 0; i + 2 < u.size(); i += 3) most = std::max(most, norm(Vec3{u[i], u[i + 1], u[i + 2]}));
  return most;
}

Panel axes_of(std::string label, const std::array<TimeLine, 3>& lines) {
  Panel out{std::move(label)};
  for (std::size_t k = 0; k < lines.size(); ++k) out.lines.push_back({kAxes[k], lines[k].points()});
  return out;
}

}  // namespace

MotionFigure::MotionFigure(const TraceInfo& info) : info_(info), users_(info.users.size()), meshes_(info.meshes.size()) {
  for (std::size_t i = 0; i < info.objects.size() && objects_.size() < kMostObjects; ++i)
    if (info.objects[i].dof != Dof::none) objects_.push_back({i});
}

void MotionFigure::add(const TraceFrame& frame) {
  const double time = end_ = time_of(frame.tick);
  for (ObjectLines& lines : objects_) add(lines, frame.objects[lines.object], time);
  for (std::size_t i = 0; i < users_.size(); ++i) add(users_[i], frame.users[i], time);
  for (std::size_t i = 0; i < meshes_.size(); ++i)
    if (frame.meshes[i].updated) meshes_[i].add(time, kMillimetres * largest(frame.meshes[i].displacements));
}

void MotionFigure::add(ObjectLines& lines, const RigidSample& sample, double time) {
  const auto parts = components(sample.pose.position);
  for (std::size_t k = 0; k < parts.size(); ++k) lines.position[k].add(time, kMillimetres * parts[k]);
  lines.has_speed = lines.has_speed || sample.velocity != Vec3{};
  lines.speed.add(time, kMillimetres * norm(sample.velocity));
}

void MotionFigure::add(UserLines& lines, const UserSample& user, double time) {
  const auto parts = components(user.device.position);
  for (std::size_t k = 0; k < parts.size(); ++k) lines.device[k].add(time, kMillimetres * parts[k]);
  lines.felt.add(time, norm(user.force));
  lines.server.add(time, norm(user.server_force));
  lines.differ = lines.differ || user.force != user.server_force;
}

void MotionFigure::add_packet(std::int64_t tick, std::size_t bytes) {
  packets_.add(time_of(tick));
  kilobits_.add(time_of(tick), kKilobits * static_cast<double>(bytes));
}

std::vector<Panel::Line> MotionFigure::force_lines(const UserLines& of, KnownForces known) {
  if (known == KnownForces::server) return {{"of the server", of.server.points()}};
  if (known == KnownForces::felt) return {{"felt", of.felt.points()}};
  if (!of.differ) return {{"force", of.felt.points()}};
  return {{"felt", of.felt.points()}, {"of the server", of.server.points()}};
}

std::vector<Panel> MotionFigure::panels() const {
  std::vector<Panel> out;
  Panel speeds{"speed [mm/s]"}, bends{"largest displacement [mm]"};
  for (const ObjectLines& lines : objects_) {
    const std::string& name = info_.objects[lines.object].name;
    out.push_back(axes_of("position of " + name + " [mm]", lines.position));
    if (lines.has_speed) speeds.lines.push_back({name, lines.speed.points()});
  }
  out.push_back(std::move(speeds));
  for (std::size_t i = 0; i < users_.size(); ++i) {
    const std::string& name = info_.users[i].name;
    out.push_back(axes_of("device of " + name + " [mm]", users_[i].device));
    out.push_back({"force on " + name + " [N]", force_lines(users_[i], info_.users[i].forces)});
  }
  for (std::size_t i = 0; i < meshes_.size(); ++i)
    if (!meshes_[i].is_empty()) bends.lines.push_back({info_.meshes[i].name, meshes_[i].points()});
  out.push_back(std::move(bends));
  if (packets_.is_empty()) return out;
  const double width = width_of_rates(end_);
  out.push_back({"packets per second", {{"packets", packets_.points(width, end_)}}});
  out.push_back({"payload [kbit/s]", {{"payload", kilobits_.points(width, end_)}}});
  return out;
}

}  // namespace tactus::cli
