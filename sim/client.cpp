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
      rigid_(scene_, receiver_ ? RigidView::News::of_all : RigidView::News::of_changed),
      felt_(scene_.users.size()) {
  poses_.assign(rigid_.poses().begin(), rigid_.poses().end());
  objects_.push_back(&rigid_);
  if (!scene_.msds.empty()) {
    msds_.emplace(scene_);
    poses_.insert(poses_.end(), msds_->poses().begin(), msds_->poses().end());
    objects_.push_back(&*msds_);
  }
  DeformableObjects* deformables = server.deformables();
  if (!deformables) return;
  for (const TraceDeformable& mesh : deformables->meshes()) places_.push_back({centre(mesh.rest), {}});
  if (receiver_) objects_.push_back(&deformables_.emplace(scene_, deformables->meshes()));
  else objects_.push_back(&deformables->true_view());
}

Result<std::unique_ptr<Client>> Client::create(Server& server, const ReplicaOptions& replica) {
  std::optional<Receiver> receiver;
  if (SharedScene declared = server.stream_scene()) {
    TACTUS_TRY(receiver, Receiver::create(std::move(declared), {.replica = replica, .limits = {}}));
  }
  return std::unique_ptr<Client>(new Client(server, std::move(receiver)));
}

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
  Replica& replica = receiver_->replica();
  const unsigned position_exp = receiver_->scene()->grid.position;
  for (std::size_t i = 0; i < truth.meshes.size(); ++i)
    if (truth.meshes[i].updated) deformables_->show(i, replica.displacements(i, truth.tick), position_exp);
  for (std::uint32_t i = 0; i < poses_.size(); ++i) show_pose(i, to_pose(replica.pose(i, truth.tick), position_exp));
}

void Client::touch(std::span<const DeviceSample> devices) noexcept {
  for (std::size_t i = 0; i < devices.size(); ++i) {
    Vec3 force;
    bool held = false;
    for (Touchable* objects : objects_) {
      const Touch touch = objects->touch(i, devices[i], held);
      held = held || touch.contact.kind != ContactKind::none;
      force = force + touch.force;
    }
    felt_[i] = share_rendered(force, scene_.users[i].device.max_force) * force;
  }
}

const Pose& Client::watched(std::size_t user) const noexcept {
  const std::size_t object = scene_.users[user].object;
  return object < poses_.size() ? poses_[object] : places_[object - poses_.size()];
}

}  // namespace tactus::sim
