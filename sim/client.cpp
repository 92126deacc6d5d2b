// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/client.h>

#include <algorithm>
#include <utility>

#include <tactus/sim/tets/tet_mesh.h>

namespace tactus::sim {
namespace {

/// Of the mesh's box [m].
Vec3 centre(const TriMesh& mesh) {
  const auto [low, high] = bounds(mesh.vertices);
  return 0.5 * (low + high);
}

}  // namespace

Client::Client(Server& server, std::optional<Receiver> receiver)
    : scene_(server.scene()),
      receiver_(std::move(receiver)),
      rigid_(scene_, server.stream_scene() ? RigidView::News::of_all : RigidView::News::of_changed),
      felt_(scene_.users.size()),
      contacts_(scene_.users.size()) {
  poses_.assign(rigid_.poses().begin(), rigid_.poses().end());
  objects_.push_back(&rigid_);
  if (!scene_.msds.empty()) {
    msds_.emplace(scene_);
    poses_.insert(poses_.end(), msds_->poses().begin(), msds_->poses().end());
    objects_.push_back(&*msds_);
  }
  DeformableObjects* deformables = server.deformables();
  if (!deformables) return;
  for (const TraceDeformable& mesh : deformables->meshes()) {
    places_.push_back({centre(mesh.rest), {}});
    shown_.push_back({.period = mesh.period});
  }
  if (server.stream_scene()) objects_.push_back(&deformables_.emplace(scene_, deformables->meshes()));
  else objects_.push_back(&deformables->true_view());
}

Result<std::unique_ptr<Client>> Client::create(Server& server, const ReplicaOptions& replica) {
  std::optional<Receiver> receiver;
  if (SharedScene declared = server.stream_scene()) {
    TACTUS_TRY(receiver, Receiver::create(std::move(declared), {.replica = replica, .limits = {}}));
  }
  return std::unique_ptr<Client>(new Client(server, std::move(receiver)));
}

std::unique_ptr<Client> Client::create_remote(Server& server) { return std::unique_ptr<Client>(new Client(server, {})); }

Result<void> Client::receive(std::span<const Packet> packets) noexcept {
  for (const Packet& packet : packets) TACTUS_CHECK(receiver_->push(packet.bytes));
  return {};
}

void Client::show_pose(std::uint32_t object, const Pose& pose) noexcept {
  poses_[object] = pose;
  if (object < scene_.objects.size()) rigid_.show(object, pose);
  else msds_->show(object - scene_.objects.size(), pose);
}

void Client::show(const TraceFrame& truth) noexcept {
  if (!receiver_) {
    for (const std::uint32_t i : *truth.changed) show_pose(i, truth.objects[i].pose);
    return;
  }
  for (std::size_t i = 0; i < truth.meshes.size(); ++i)
    if (truth.meshes[i].updated) show_shape(*receiver_, truth.tick, i);
  show_poses(*receiver_, truth.tick);
}

void Client::show(Receiver& receiver, std::int64_t tick) noexcept {
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    ShownMesh& mesh = shown_[i];
    const auto frame = static_cast<std::int64_t>(static_cast<double>(tick) / mesh.period);
    const double rests = static_cast<double>(receiver.tick(i + 1) + receiver.scene()->max_extrapolation) + mesh.period;
    if (frame == mesh.frame || static_cast<double>(tick) > rests) continue;
    mesh.frame = frame;
    show_shape(receiver, tick, i);
  }
  show_poses(receiver, tick);
}

void Client::show_shape(Receiver& receiver, std::int64_t tick, std::size_t mesh) noexcept {
  deformables_->show(mesh, receiver.replica().displacements(mesh, tick), receiver.scene()->grid.position);
}

void Client::show_poses(Receiver& receiver, std::int64_t tick) noexcept {
  for (std::uint32_t i = 0; i < poses_.size(); ++i)
    show_pose(i, to_pose(receiver.replica().pose(i, tick), receiver.scene()->grid.position));
}

void Client::touch(std::span<const DeviceSample> devices) noexcept {
  for (std::size_t i = 0; i < devices.size(); ++i) touch(i, devices[i], 1);
}

void Client::touch(std::size_t user, const DeviceSample& device, double share) noexcept {
  Vec3 force;
  bool held = false;
  contacts_[user].reset();
  for (Touchable* objects : objects_) {
    const Touch touch = objects->touch(user, device, held);
    if (touch.contact.kind != ContactKind::none) contacts_[user] = {touch.proxy, touch.contact.stiffness};
    else if (touch.surface) contacts_[user] = {touch.surface->proxy, touch.surface->stiffness};
    held = held || touch.contact.kind != ContactKind::none;
    force = force + touch.force;
  }
  felt_[user] = share * share_rendered(force, scene_.users[user].device.max_force) * force;
}

const Pose& Client::watched(std::size_t user) const noexcept {
  const std::size_t object = scene_.users[user].object;
  return object < poses_.size() ? poses_[object] : places_[object - poses_.size()];
}

}  // namespace tactus::sim
