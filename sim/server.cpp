// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/server.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <tactus/sim/deformable/elastic_physics.h>
#include <tactus/sim/deformable/stiffness_map.h>
#include <tactus/sim/msd/msd_objects.h>

namespace tactus::sim {

Server::Server(const Scene& scene, const ServerOptions& options)
    : scene_(scene),
      noise_(~options.seed),
      noise_reach_(std::sqrt(3.0) * options.mesh_noise),
      held_(scene.users.size(), 1),
      fractions_(scene.users.size(), 1) {
  const std::size_t objects = scene.objects.size() + scene.msds.size();
  frame_.objects.resize(objects);
  frame_.changed.emplace().reserve(objects);
  frame_.users.resize(scene.users.size());
}

Result<std::unique_ptr<Server>> Server::create(const Scene& scene, const ServerOptions& options) {
  std::unique_ptr<Server> server(new Server(scene, options));
  TACTUS_CHECK(server->add_objects(options));
  if (options.codec) TACTUS_CHECK(server->add_codec(*options.codec));
  return server;
}

/// Add the rigid objects, and the other kinds if the scene has them.
Result<void> Server::add_objects(const ServerOptions& options) {
  auto rigid = std::make_unique<RigidObjects>(scene_, RigidEffort{.parts = options.parts});
  rigid_ = rigid.get();
  objects_.push_back(std::move(rigid));
  if (!scene_.msds.empty()) {
    TACTUS_TRY(auto msds, MsdObjects::create(scene_));
    objects_.push_back(std::move(msds));
  }
  if (scene_.deformables.empty()) return {};
  TACTUS_TRY(auto deformables, make_deformable_objects(scene_, {.true_views = !options.codec && options.has_clients,
                                                                .estimate_every = options.estimate_every,
                                                                .parts = options.parts,
                                                                .as_bodies = options.codec && options.codec->sessions,
                                                                .report_at_rest = options.mesh_noise != 0}));
  for (const TraceDeformable& mesh : deformables->meshes())
    frame_.meshes.push_back({false, std::vector<float>(3 * mesh.rest.vertices.size())});
  deformables_ = deformables.get();
  objects_.push_back(std::move(deformables));
  return {};
}

/// What the clients know of the objects that their devices push or hold.
Server::Driven Server::driven_objects(double model_scale) const {
  Driven out(scene_.objects.size());
  if (model_scale == 0) return out;
  for (std::uint32_t i = 0; i < scene_.objects.size(); ++i) {
    const SceneObject& object = scene_.objects[i];
    if (object.dof == Dof::none || !scene_.touch) continue;
    const DrivenPhysics physics{.mass = model_scale * object.mass,
                                .inertia = model_scale * rigid_->inertia(i),
                                .stiffness = scene_.touch->stiffness,
                                .hold = scene_.touch->lift_stiffness,
                                .friction = scene_.touch->friction,
                                .damping = kTickRate * (1 - object.damping)};
    if (SceneBuilder::can_drive(physics, kTickRate)) out[i] = physics;
  }
  return out;
}

/// Gravity, and the friction of the objects on the floor.
MotionPhysics Server::motion_physics() const {
  MotionPhysics out{.gravity = scene_.gravity};
  for (const SceneObject& object : scene_.objects)
    if (object.dof != Dof::none) out.friction = std::max(out.friction, object.friction);
  return out;
}

Result<void> Server::add_codec(const ServerCodec& codec) {
  const bool drives = codec.sessions && codec.coding.rigid == RigidProfile::main;
  SceneBuilder builder = scene_builder(scene_, drives ? driven_objects(codec.client_model_scale) : Driven{});
  if (drives) builder.motion(motion_physics());
  builder.rigid_profile(codec.coding.rigid);
  for (std::size_t i = 0; i < scene_.deformables.size(); ++i) {
    TraceCoding coding = codec.coding;
    if (scene_.compensation && scene_.compensation->is_softer()) {
      TACTUS_TRY(auto map, stiffness_map(scene_.deformables[i]));
      coding.deformable.stiffness = std::move(map.stiffness);
    }
    if (codec.sessions && coding.deformable.profile == DeformableProfile::main && !coding.deformable.layered)
      coding.deformable.elastic =
          elastic_physics(scene_.deformables[i], scene_.gravity, deformables_->info()[i].shared, codec.client_model_scale);
    TACTUS_CHECK(add_deformable(builder, deformables_->meshes()[i], coding));
  }
  builder.declare_bounds(codec.sender.triggers, codec.sender.deformable.thresholds, codec.sender.load);
  constexpr std::uint8_t kBaselines = 64;
  if (codec.sessions) builder.baselines(kBaselines);
  if (codec.sessions && scene_.interest) builder.interest(scene_.interest->full, scene_.interest->reach);
  TACTUS_TRY(declared_, builder.build(codec.limits));
  truth_.emplace(info());
  if (codec.sessions) return {};
  TACTUS_TRY(sender_, Sender::create(declared_, codec.sender));
  return {};
}

void Server::observe() noexcept {
  for (const auto& objects : objects_) objects->observe(frame_);
  if (noise_reach_ > 0) add_noise();
}

void Server::add_noise() noexcept {
  for (DeformableSample& mesh : frame_.meshes)
    if (mesh.updated)
      for (float& u : mesh.displacements) u += static_cast<float>(noise_.uniform(-noise_reach_, noise_reach_));
}

void Server::touch(std::span<const DeviceSample> devices) noexcept {
  for (std::size_t i = 0; i < devices.size(); ++i) {
    UserSample& user = frame_.users[i] = {.device = devices[i], .contact = {}, .force = {}, .server_force = {}};
    user.contact.device = devices[i].position;
    for (const auto& objects : objects_) {
      const Touch touch = objects->touch(i, devices[i], user.contact.kind != ContactKind::none);
      if (touch.contact.kind != ContactKind::none) user.contact = touch.contact;
      if (touch.surface) user.surface_contact = touch.surface;
      user.server_force = user.server_force + touch.force;
    }
    fractions_[i] = held_[i] * rendered_fraction(user.server_force, scene_.users[i].device.max_force);
    user.force = user.server_force = fractions_[i] * user.server_force;
    if (!user.surface_contact) continue;
    // A user who touches a sleeping object needs its shape at haptic, not visual, accuracy.
    DeformableSample& mesh = frame_.meshes[user.surface_contact->mesh];
    mesh.updated = mesh.updated || deformables_->is_due(user.surface_contact->mesh);
  }
}

Truth Server::truth() noexcept {
  Truth out = truth_->of(frame_);
  out.loads = rigid_->loads();
  return out;
}

Result<std::span<const Packet>> Server::encode() noexcept {
  if (!sender_) return std::span<const Packet>();
  return sender_->encode(frame_.tick, truth());
}

std::span<const HeldPart> Server::held() const noexcept { return sender_ ? sender_->held() : std::span<const HeldPart>(); }

tl::expected<void, Diagnostic> Server::step() {
  for (std::size_t i = 0; i < fractions_.size(); ++i)
    for (const auto& objects : objects_) objects->push(i, fractions_[i]);
  for (const auto& objects : objects_) TACTUS_CHECK(objects->step());
  return {};
}

TraceInfo Server::info() const {
  TraceInfo info{.tick_rate = kTickRate, .objects = {}, .users = {}, .source = {}, .scene = scene_.text};
  for (const SceneObject& object : scene_.objects) info.objects.push_back({object.name, object.dof});
  for (const SceneMsd& msd : scene_.msds) info.objects.push_back({msd.name, msd.dof()});
  for (const SceneUser& user : scene_.users) info.users.push_back({user.name, user.senses()});
  if (deformables_) info.meshes.assign(deformables_->meshes().begin(), deformables_->meshes().end());
  return info;
}

}  // namespace tactus::sim
