// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/simulation.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <tactus/sim/contact/contact.h>
#include <tactus/sim/user/sampled_limit.h>
#include <tactus/sim/user/user.h>

namespace tactus::sim {
namespace {

struct Channel {
  Sender sender;
  Receiver receiver;
  FrameTruth truth;
};

struct User {
  Hand hand;
  Probe server;
  Probe client;
  double max_force;
  DeviceSample device;
  Touch touch;            // at the server
  DeformableTouch press;  // likewise, of deformables
  double share;           // of both that the device can yield
  Vec3 rendered;          // by the server, within the device's limit
  Vec3 felt;              // by the client
  TouchRecord record{};
};

/// How much of a force a device renders.
double share_rendered(const Vec3& force, double limit) {
  const double magnitude = norm(force);
  return magnitude > limit ? limit / magnitude : 1;
}

/// Of the mesh's box [m].
Vec3 centre(const TriMesh& mesh) {
  Vec3 low = mesh.vertices[0], high = low;
  for (const Vec3& v : mesh.vertices) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  return 0.5 * (low + high);
}

}  // namespace

struct Simulation::Impl {
  Scene scene;
  std::uint64_t seed;
  Random noise;
  double mesh_noise = 0;  // [m]
  RigidWorld world;
  std::optional<Channel> channel;
  std::vector<User> users;
  TraceFrame frame;
  std::vector<Pose> true_poses, client_poses;
  std::unique_ptr<MsdWorld> msds;                // none: the scene has none
  std::unique_ptr<DeformableWorld> deformables;  // likewise
  std::vector<Pose> places;                      // of the deformables, for who looks at one

  Impl(Scene of, std::uint64_t from) : scene(std::move(of)), seed(from), noise(~from), world(scene) {}

  void observe();
  void touch_server();
  void report_touched(std::uint32_t mesh);
  Result<std::span<const Packet>> transmit();
  Result<void> add_deformables(const SimulationOptions& options);
  Result<void> add_channel(const ChannelOptions& options);
  void touch_client();
  tl::expected<void, StepError> act();
  tl::expected<std::span<const Packet>, StepError> tick();
  const Pose& watched(const SceneUser& user) const;
};

const Pose& Simulation::Impl::watched(const SceneUser& user) const {
  return user.object < client_poses.size() ? client_poses[user.object] : places[user.object - client_poses.size()];
}

/// Truth at this tick, as it is before any force of this tick acts.
void Simulation::Impl::observe() {
  frame.tick = world.tick();
  for (const std::uint32_t i : world.changed()) {
    frame.objects[i] = world.sample(i);
    for (User& user : users) {
      user.server.attend(i, true_poses[i]);
      user.client.attend(i, true_poses[i]);
    }
    true_poses[i] = frame.objects[i].pose;
  }
  if (msds) msds->observe(std::span(frame.objects).subspan(scene.objects.size()));
  frame.changed->assign(world.changed().begin(), world.changed().end());
  for (std::size_t i = scene.objects.size(); i < true_poses.size(); ++i) {
    true_poses[i] = frame.objects[i].pose;
    frame.changed->push_back(static_cast<std::uint32_t>(i));
  }
  if (!deformables) return;
  deformables->observe(frame.meshes);
  if (mesh_noise == 0) return;
  const double reach = std::sqrt(3.0) * mesh_noise;  // of a uniform distribution with that RMS
  for (DeformableSample& mesh : frame.meshes)
    if (mesh.updated)
      for (float& u : mesh.displacements) u += static_cast<float>(noise.uniform(-reach, reach));
}

void Simulation::Impl::touch_server() {
  for (std::size_t i = 0; i < users.size(); ++i) {
    User& user = users[i];
    user.touch = user.server.move(user.device.position, user.device.button, true_poses);
    if (msds) {
      const bool held = user.touch.contact.kind != ContactKind::none;
      const Touch touch = msds->touch_server(i, held ? std::nullopt : std::optional(user.device.position));
      if (!held) user.touch = touch;
    }
    Vec3 force = user.touch.force;
    if (deformables) {
      user.press = deformables->touch_server(i, user.device.position);
      force = force + user.press.force;
      if (user.press.contact) report_touched(user.press.contact->mesh);
    }
    user.share = share_rendered(force, user.max_force);
    user.rendered = user.share * force;
    frame.users[i] = {
        .contact = user.touch.contact, .force = {}, .server_force = user.rendered, .surface_contact = user.press.contact};
  }
}

/// Who touches an object that sleeps needs its shape to what a hand feels, not to what an eye sees.
void Simulation::Impl::report_touched(std::uint32_t mesh) {
  frame.meshes[mesh].updated = frame.meshes[mesh].updated || deformables->is_due(mesh);
}

Result<std::span<const Packet>> Simulation::Impl::transmit() {
  if (!channel) {
    for (const std::uint32_t i : world.changed()) client_poses[i] = true_poses[i];
    for (std::size_t i = scene.objects.size(); i < client_poses.size(); ++i) client_poses[i] = true_poses[i];
    return std::span<const Packet>();
  }
  TACTUS_TRY(const auto packets, channel->sender.encode(frame.tick, channel->truth.of(frame)));
  for (const Packet& packet : packets) TACTUS_CHECK(channel->receiver.push(packet.bytes));
  Replica& replica = channel->receiver.replica();
  const unsigned position_exp = channel->receiver.scene()->grid.position;
  for (std::size_t i = 0; i < frame.meshes.size(); ++i)
    if (frame.meshes[i].updated) deformables->show(i, replica.displacements(i, frame.tick), position_exp);
  for (std::uint32_t i = 0; i < client_poses.size(); ++i) client_poses[i] = to_pose(replica.pose(i, frame.tick), position_exp);
  return packets;
}

void Simulation::Impl::touch_client() {
  for (std::size_t i = 0; i < users.size(); ++i) {
    User& user = users[i];
    const Touch touch = user.client.move(user.device.position, user.device.button, client_poses);
    Vec3 force = touch.force;
    if (msds) {
      const bool held = touch.contact.kind != ContactKind::none;
      force = force + msds->touch_client(i, held ? std::nullopt : std::optional(user.device.position),
                                         std::span(client_poses).subspan(scene.objects.size()));
    }
    if (deformables) force = force + deformables->touch_client(i, user.device.position).force;
    user.felt = share_rendered(force, user.max_force) * force;
    frame.users[i].force = user.felt;
    user.record.add(frame.users[i], user.device.position);
  }
}

tl::expected<void, StepError> Simulation::Impl::act() {
  for (const User& user : users) {
    const Contact& contact = user.touch.contact;
    const Vec3 pushed = -(user.share * user.touch.force);
    if (contact.kind != ContactKind::none && contact.object < scene.objects.size())
      world.push(contact.object, pushed, user.touch.proxy);
    else if (contact.kind != ContactKind::none) msds->push(contact.object - scene.objects.size(), pushed);
    if (user.press.contact) deformables->push(*user.press.contact, -(user.share * user.press.force));
  }
  if (msds)
    if (auto deformed = msds->step(); !deformed) return deformed;
  if (deformables)
    if (auto deformed = deformables->step(); !deformed) return deformed;
  return world.step();
}

tl::expected<std::span<const Packet>, StepError> Simulation::Impl::tick() {
  touch_server();
  const auto packets = transmit();
  if (!packets) return tl::unexpected(StepError{packets.error(), frame.tick, 0});
  touch_client();
  if (const auto moved = act(); !moved) return tl::unexpected(moved.error());
  return *packets;
}

Result<void> Simulation::Impl::add_deformables(const SimulationOptions& options) {
  const auto clients = options.channel ? DeformableClients::shown : DeformableClients::true_shape;
  TACTUS_TRY(deformables, make_deformable_world(scene, {.users = scene.users.size(),
                                                        .clients = clients,
                                                        .estimate_every = options.estimate_every,
                                                        .report_at_rest = options.mesh_noise != 0}));
  for (const TraceDeformable& mesh : deformables->meshes()) {
    places.push_back({centre(mesh.rest), {}});
    frame.meshes.push_back({false, std::vector<float>(3 * mesh.rest.vertices.size())});
  }
  return {};
}

Result<void> Simulation::Impl::add_channel(const ChannelOptions& options) {
  SceneBuilder builder = scene_builder(scene);
  if (deformables)
    for (const TraceDeformable& mesh : deformables->meshes()) TACTUS_CHECK(add_deformable(builder, mesh, options.coding));
  builder.promise(options.sender.triggers, options.sender.deformable.thresholds);
  TACTUS_TRY(SharedScene declared, builder.build());
  TACTUS_TRY(Sender sender, Sender::create(declared, options.sender));
  TACTUS_TRY(Receiver receiver, Receiver::create(declared, {.replica = options.replica, .limits = {}}));
  TraceInfo info;
  info.users.resize(scene.users.size());
  info.meshes.resize(frame.meshes.size());
  channel.emplace(Channel{std::move(sender), std::move(receiver), FrameTruth(info)});
  return {};
}

Result<Simulation> Simulation::create(const Scene& scene, const SimulationOptions& options) {
  auto impl = std::make_unique<Impl>(scene, options.seed);
  const std::size_t objects = scene.objects.size() + scene.msds.size();
  impl->mesh_noise = options.mesh_noise;
  if (!scene.deformables.empty()) TACTUS_CHECK(impl->add_deformables(options));
  if (options.channel) TACTUS_CHECK(impl->add_channel(*options.channel));
  Random seeds(options.seed);
  std::optional<Probe> probe;  // where every probe begins
  if (!scene.users.empty()) probe.emplace(scene.objects, *scene.touch);
  if (probe && !options.channel) probe->expect_attend();
  for (const SceneUser& user : scene.users) {
    impl->users.push_back(User{.hand = Hand(user, options.grip.value_or(user.grip), seeds.next()),
                               .server = *probe,
                               .client = *probe,
                               .max_force = user.device.max_force,
                               .device = {},
                               .touch = {},
                               .press = {},
                               .share = 1,
                               .rendered = {},
                               .felt = {}});
  }
  if (!scene.msds.empty()) {
    TACTUS_TRY(impl->msds, MsdWorld::create(scene));
  }
  impl->frame.objects.resize(objects);
  impl->frame.changed.emplace().reserve(objects);
  impl->frame.users.resize(scene.users.size());
  impl->true_poses.resize(objects);
  for (const SceneObject& object : scene.objects) impl->client_poses.push_back(object.pose);
  for (const SceneMsd& msd : scene.msds) impl->client_poses.push_back({msd.position, {}});
  return Simulation(std::move(impl));
}

tl::expected<std::span<const Packet>, StepError> Simulation::step() {
  Impl& in = *impl_;
  in.observe();
  for (std::size_t i = 0; i < in.users.size(); ++i) {
    User& user = in.users[i];
    user.device = user.hand.step(user.felt, in.watched(in.scene.users[i]));
  }
  return in.tick();
}

tl::expected<std::span<const Packet>, StepError> Simulation::replay(std::span<const UserSample> recorded) {
  Impl& in = *impl_;
  in.observe();
  const auto refuse = [&](const char* rule) {
    return tl::unexpected(StepError{Error{Errc::invalid_argument, rule, 0}, in.frame.tick, 0});
  };
  if (recorded.size() != in.users.size()) return refuse("R-API-5");
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    if (!is_finite(recorded[i].contact.device)) return refuse("R-API-1");
    in.users[i].device = {recorded[i].contact.device, recorded[i].contact.kind == ContactKind::spring};
  }
  return in.tick();
}

const TraceFrame& Simulation::frame() const noexcept { return impl_->frame; }
std::span<const Pose> Simulation::client_poses() const noexcept { return impl_->client_poses; }
const DeformableWorld* Simulation::deformables() const noexcept { return impl_->deformables.get(); }
const TouchSummary& Simulation::touched(std::size_t user) const noexcept { return impl_->users[user].record.summary(); }
Replica& Simulation::replica() noexcept { return impl_->channel->receiver.replica(); }
const SharedScene& Simulation::stream_scene() const noexcept { return impl_->channel->receiver.scene(); }

double Simulation::bears(std::size_t user) const noexcept {
  return sampled_limit(impl_->users[user].hand.impedance(), impl_->scene.users[user].device);
}

std::int64_t Simulation::ticks() const noexcept { return std::llround(impl_->scene.duration / kTick); }

TraceInfo Simulation::info() const {
  TraceInfo info{.tick_rate = kTickRate, .objects = {}, .users = {}, .source = {}, .scene = impl_->scene.text};
  for (const SceneObject& object : impl_->scene.objects) info.objects.push_back({object.name, object.dof});
  for (const SceneMsd& msd : impl_->scene.msds) info.objects.push_back({msd.name, msd.dof()});
  for (const SceneUser& user : impl_->scene.users) info.users.push_back(user.name);
  if (impl_->deformables) info.meshes.assign(impl_->deformables->meshes().begin(), impl_->deformables->meshes().end());
  info.source = "sim " + impl_->scene.name + " seed " + std::to_string(impl_->seed);
  return info;
}

Simulation::Simulation(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

}  // namespace tactus::sim
