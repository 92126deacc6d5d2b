// SPDX-License-Identifier: Apache-2.0
#include "cli/figure/time_figure.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::cli {

// ==== lines ====

void TimeLine::add(double time, double value) {
  const Sample sample{time, value};
  if (in_last_ == per_piece_ || pieces_.empty()) {
    if (pieces_.size() == kMost) {
      for (std::size_t i = 0; i < kMost / 2; ++i) {
        const Piece &a = pieces_[2 * i], &b = pieces_[2 * i + 1];
        pieces_[i] = {a.low.value <= b.low.value ? a.low : b.low, a.high.value >= b.high.value ? a.high : b.high};
      }
      pieces_.resize(kMost / 2);
      per_piece_ *= 2;
    }
    pieces_.push_back({sample, sample});
    in_last_ = 0;
  }
  ++in_last_;
  Piece& last = pieces_.back();
  if (value < last.low.value) last.low = sample;
  if (value > last.high.value) last.high = sample;
}

std::vector<Point> TimeLine::points() const {
  std::vector<Point> out;
  for (const Piece& piece : pieces_) {
    const auto& [a, b] = piece.low.time <= piece.high.time ? std::pair(piece.low, piece.high) : std::pair(piece.high, piece.low);
    out.push_back({a.time, a.value});
    if (b.time > a.time) out.push_back({b.time, b.value});
  }
  return out;
}

std::vector<Point> RateLine::points(double width, double end) const {
  std::vector<double> sums(static_cast<std::size_t>(end / width) + 1);
  for (const auto& [time, amount] : events_) sums[std::min(static_cast<std::size_t>(time / width), sums.size() - 1)] += amount;
  std::vector<Point> out;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double from = width * static_cast<double>(i), to = std::min(from + width, end);
    if (to - from < 0.5 * width && i > 0) break;  // too short for a rate
    out.push_back({from, sums[i] / (to - from)});
    out.push_back({to, sums[i] / (to - from)});
  }
  return out;
}

double width_of_rates(double duration) {
  const double wanted = std::max(duration, 1e-3) / 60, power = std::pow(10, std::floor(std::log10(wanted)));
  for (const double digit : {1.0, 2.0, 5.0})
    if (digit * power >= wanted * (1 - 1e-9)) return digit * power;
  return 10 * power;
}

// ==== motion ====

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
  lines.rendered.add(time, norm(user.force));
  lines.server.add(time, norm(user.server_force));
  lines.differ = lines.differ || user.force != user.server_force;
}

void MotionFigure::add_packet(std::int64_t tick, std::size_t bytes) {
  packets_.add(time_of(tick));
  kilobits_.add(time_of(tick), kKilobits * static_cast<double>(bytes));
}

std::vector<Panel::Line> MotionFigure::force_lines(const UserLines& of, RecordedForces known) {
  if (known == RecordedForces::server) return {{"of the server", of.server.points()}};
  if (known == RecordedForces::rendered) return {{"rendered", of.rendered.points()}};
  if (!of.differ) return {{"force", of.rendered.points()}};
  return {{"rendered", of.rendered.points()}, {"of the server", of.server.points()}};
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

// ==== errors ====

namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

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
