// SPDX-License-Identifier: Apache-2.0
#include "cli/viewer/columns.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <utility>

#include <tactus/deformable/displacement.h>
#include <tactus/rigid/trigger.h>
#include <tactus/scene/scene_syntax.h>
#include <tactus/thesis/if_built.h>

namespace tactus::cli {

// ==== columns ====

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (k < count ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += k <= count ? kDigits[group >> (18 - 6 * k) & 63u] : '=';
  }
  return out;
}

void Column::add(std::int64_t value) {
  const std::int64_t difference = value - last_;
  last_ = value;
  ++count_;
  if (difference == 0) {
    ++zeros_;
    return;
  }
  end_run();
  put(static_cast<std::uint64_t>(difference) << 1 ^ static_cast<std::uint64_t>(difference >> 63));
}

void Column::end_run() {
  if (zeros_ == 0) return;
  put(0);
  put(zeros_ - 1);
  zeros_ = 0;
}

void Column::put(std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) data_ += static_cast<char>(value | 0x80);
  data_ += static_cast<char>(value);
}

nlohmann::ordered_json Column::take() {
  end_run();
  nlohmann::ordered_json out{{"step", step_}, {"count", count_}, {"data", base64(data_)}};
  *this = Column(step_);
  return out;
}

// ==== packet log ====

Result<PacketLog> PacketLog::create(const SharedScene& scene, const SenderOptions& options) {
  TACTUS_TRY(Sender sender, Sender::create(scene, options));
  TACTUS_TRY(Receiver receiver, Receiver::create(scene));
  return PacketLog(std::move(sender), std::move(receiver));
}

Result<void> PacketLog::add(std::int64_t tick, const Truth& truth) {
  TACTUS_TRY(const auto packets, sender_.encode(tick, truth));
  for (const Packet& packet : packets) {
    TACTUS_TRY(const DecodedPacket decoded, receiver_.push(packet.number, packet.bytes));
    PlayedPacket placed;
    static_cast<DecodedPacket&>(placed) = decoded;
    placed.bytes = packet.bytes.size();
    placed.offset = bytes_.size();
    packets_.add(placed);
    bytes_.append(reinterpret_cast<const char*>(packet.bytes.data()), packet.bytes.size());
  }
  return {};
}

nlohmann::ordered_json PacketLog::hashes() const {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  const std::size_t substreams = scene().deformables.size() + (scene().loads ? 2U : 1U);
  for (std::size_t i = 0; i < substreams; ++i) out.push_back(fmt::format("{:016x}", sender_.state_hash(i)));
  return out;
}

nlohmann::ordered_json PacketLog::take() {
  nlohmann::ordered_json out{{"stream", base64(bytes_)}, {"packets", packets_.take()}};
  bytes_.clear();
  return out;
}

Result<std::string> declaration_of(const Scene& scene) {
  TACTUS_TRY(const auto bytes, write_scene(scene));
  return base64({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

// ==== truth data ====

namespace {

constexpr double kFraction = 0.05;  // of the stream's bounds
// What the grid of every stream can hold.
constexpr double kLeastLength = 4e-6, kLeastAngle = 1e-4;  // [m], [rad]

constexpr const char* kKnown[] = {"both", "rendered", "server"};  // index: RecordedForces

enum class Touch : std::uint8_t { none = 0, surface = 1, spring = 2, mesh = 3 };

Touch touch_of(const UserSample& user) {
  if (user.contact.kind == ContactKind::surface) return Touch::surface;
  if (user.contact.kind == ContactKind::spring) return Touch::spring;
  return user.surface_contact ? Touch::mesh : Touch::none;
}

/// Where a user touches.
Vec3 contact_point_of(const UserSample& user, const TraceFrame& frame, Touch touch) {
  if (touch == Touch::mesh) return user.surface_contact->proxy;
  return to_world(frame.objects[user.contact.object].pose, user.contact.point);
}

bool has_weber_bound(const RigidTriggers& bounds) {
  return bounds.haptic == HapticRule::isotropic || bounds.haptic == HapticRule::perceptual;
}

}  // namespace

GhostBounds ghost_bounds(const Scene& scene) {
  GhostBounds ghost;
  const RigidTriggers rigid = scene.bounds && scene.bounds->rigid ? *scene.bounds->rigid : RigidTriggers{};
  ghost.rigid.visual_position = std::max(kLeastLength, kFraction * rigid.visual_position);
  ghost.rigid.visual_rotation = std::max(kLeastAngle, kFraction * rigid.visual_rotation);
  ghost.rigid.haptic = HapticRule::off;
  double visual = DeformableThresholds{}.visual;
  if (scene.bounds)
    for (const DeformableBounds& mesh : scene.bounds->deformables) visual = std::min(visual, mesh.thresholds.visual);
  ghost.deformable = {.visual = std::max(kLeastLength, kFraction * visual), .weber_fraction = {}};
  return ghost;
}

Result<TruthData> TruthData::create(const TraceInfo& info, const TraceFrame& first, const Scene& scene) {
  const GhostBounds bounds = ghost_bounds(scene);
  const SenderOptions options{.triggers = bounds.rigid, .deformable = {.thresholds = bounds.deformable}};
  TACTUS_TRY(SceneBuilder builder, scene_builder(info, first, {}, options));
  TACTUS_TRY(const SharedScene shared, builder.build({.thesis = thesis_if_built()}));
  TACTUS_TRY(PacketLog ghost, PacketLog::create(shared, options));
  return TruthData(info, scene, bounds, std::move(ghost));
}

TruthData::TruthData(const TraceInfo& info, const Scene& scene, const GhostBounds& bounds, PacketLog ghost)
    : info_(info),
      scene_(&scene),
      bounds_(bounds),
      ghost_(std::move(ghost)),
      truth_(info),
      users_(info.users.size()),
      meshes_(info.meshes.size()) {
  if (scene.bounds) declared_bounds_ = scene.bounds->rigid;
}

Result<void> TruthData::add(const TraceFrame& frame, Replica& shown) {
  TACTUS_CHECK(ghost_.add(frame.tick, truth_.of(frame)));
  std::vector<Pose> poses;
  for (std::uint32_t i = 0; i < frame.objects.size(); ++i)
    poses.push_back(to_pose(shown.pose(i, frame.tick), scene_->grid.position));
  ticks_.add(frame.tick);
  add_users(frame, poses);
  add_errors(frame, poses);
  add_shapes(frame, shown);
  return {};
}

void TruthData::add_users(const TraceFrame& frame, const std::vector<Pose>& shown) {
  for (std::size_t i = 0; i < users_.size(); ++i) {
    const UserSample& user = frame.users[i];
    const Touch touch = touch_of(user);
    users_[i].device.add(user.device.position);
    users_[i].kind.add(static_cast<std::int64_t>(touch));
    users_[i].contact.add(touch == Touch::none ? user.device.position : contact_point_of(user, frame, touch));
    users_[i].server.add(user.server_force);
    users_[i].rendered.add(user.force);
    const bool is_rigid = touch == Touch::surface || touch == Touch::spring;
    users_[i].shown.add(is_rigid ? contact_force(user.contact, shown[user.contact.object]) : Vec3{});
    users_[i].differ = users_[i].differ || norm(user.force - user.server_force) > 1e-3;
  }
}

/// The largest of all moving objects, and of the contact that is nearest to its bound.
void TruthData::add_errors(const TraceFrame& frame, const std::vector<Pose>& shown) {
  double position = 0, rotation = 0, error = 0, bound = 0, ratio = -1;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    if (info_.objects[i].dof == Dof::none) continue;
    const Pose& truth = frame.objects[i].pose;
    position = std::max(position, norm(shown[i].position - truth.position));
    rotation = std::max(rotation, angle_between(truth.rotation, shown[i].rotation));
  }
  for (const UserSample& user : frame.users) {
    if (user.contact.kind == ContactKind::none) continue;
    const Vec3 force = contact_force(user.contact, frame.objects[user.contact.object].pose);
    const double off = norm(contact_force(user.contact, shown[user.contact.object]) - force);
    const double budget =
        declared_bounds_ && has_weber_bound(*declared_bounds_) ? force_budget(*declared_bounds_, norm(force)) : 0;
    const double fraction = budget > 0 ? off / budget : off;
    if (fraction > ratio) ratio = fraction, error = off, bound = budget;
  }
  position_.add_real(position);
  rotation_.add_real(rotation);
  force_error_.add_real(error);
  force_bound_.add_real(bound);
}

void TruthData::add_shapes(const TraceFrame& frame, Replica& replica) {
  for (std::size_t i = 0; i < meshes_.size(); ++i) {
    if (!frame.meshes[i].updated) continue;
    const std::vector<float>& truth = frame.meshes[i].displacements;
    const auto shown = replica.displacements(i, frame.tick);
    double worst = 0;
    for (std::size_t v = 0; v < shown.size(); ++v) {
      const Vec3 there{truth[3 * v], truth[3 * v + 1], truth[3 * v + 2]};
      worst = std::max(worst, norm(to_metres(shown[v], scene_->grid.position) - there));
    }
    meshes_[i].ticks.add(frame.tick);
    meshes_[i].error.add_real(worst);
  }
}

std::size_t TruthData::bytes() const {
  std::size_t sum =
      ghost_.bytes() + ticks_.bytes() + position_.bytes() + rotation_.bytes() + force_error_.bytes() + force_bound_.bytes();
  for (const User& user : users_)
    sum += user.kind.bytes() + user.device.bytes() + user.contact.bytes() + user.server.bytes() + user.rendered.bytes() +
           user.shown.bytes();
  for (const Mesh& mesh : meshes_) sum += mesh.ticks.bytes() + mesh.error.bytes();
  return sum;
}

Result<nlohmann::ordered_json> TruthData::declare() const {
  TACTUS_TRY(auto scene, declaration_of(ghost_.scene()));
  return nlohmann::ordered_json{{"source", info_.source},
                                {"scene", std::move(scene)},
                                {"ghost_position", bounds_.rigid.visual_position},
                                {"ghost_rotation", bounds_.rigid.visual_rotation},
                                {"ghost_vertex", bounds_.deformable.visual}};
}

nlohmann::ordered_json TruthData::take() {
  nlohmann::ordered_json out = ghost_.take();
  out["ticks"] = ticks_.take();
  const bool moves = std::ranges::any_of(info_.objects, [](const TraceObject& object) { return object.dof != Dof::none; });
  if (moves) out["errors"] = {{"position", position_.take()}, {"rotation", rotation_.take()}};
  if (moves && !users_.empty()) {
    out["errors"]["force"] = force_error_.take();
    if (declared_bounds_ && has_weber_bound(*declared_bounds_)) out["errors"]["force_bound"] = force_bound_.take();
  }
  out["users"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < users_.size(); ++i) {
    User& user = users_[i];
    const RecordedForces known = info_.users[i].forces;
    nlohmann::ordered_json entry{{"name", info_.users[i].name},
                                 {"knows", kKnown[static_cast<std::size_t>(known)]},
                                 {"kind", user.kind.take()},
                                 {"device", user.device.take()},
                                 {"contact", user.contact.take()}};
    if (known != RecordedForces::rendered) entry["server"] = user.server.take();
    if (known == RecordedForces::rendered || (known == RecordedForces::both && user.differ))
      entry["rendered"] = user.rendered.take();
    if (moves) entry["shown"] = user.shown.take();
    out["users"].push_back(std::move(entry));
  }
  out["meshes"] = nlohmann::ordered_json::array();
  for (Mesh& mesh : meshes_) out["meshes"].push_back({{"ticks", mesh.ticks.take()}, {"error", mesh.error.take()}});
  return out;
}

}  // namespace tactus::cli
