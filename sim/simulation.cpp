// SPDX-License-Identifier: Apache-2.0
#include "sim/simulation.h"

#include <cmath>
#include <utility>
#include <vector>

#include "codec/rigid/rigid_decoder.h"
#include "sim/contact/contact.h"
#include "sim/user/user.h"

namespace tactus {
namespace {

struct Channel {
  RigidEncoder encoder;
  RigidDecoder decoder;
  Replica replica;
};

struct User {
  Hand hand;
  Probe server;
  Probe client;
  double max_force;
  DeviceSample device;
  Touch touch;    // at the server
  Vec3 rendered;  // by the server, within the device's limit
  Vec3 felt;      // by the client
};

Vec3 clipped(const Vec3& force, double limit) {
  const double magnitude = norm(force);
  return magnitude > limit ? (limit / magnitude) * force : force;
}

}  // namespace

struct Simulation::Impl {
  Scene scene;
  std::uint64_t seed;
  StreamHeader header;
  RigidWorld world;
  std::optional<Channel> channel;
  std::vector<User> users;
  TraceFrame frame;
  std::vector<Contact> contacts;
  std::vector<Pose> true_poses, client_poses;

  Impl(Scene of, std::uint64_t from, StreamHeader stream)
      : scene(std::move(of)), seed(from), header(std::move(stream)), world(scene) {}

  void observe();
  void touch_server();
  tl::expected<EncodedPacket, Error> transmit();
  void touch_client();
  tl::expected<void, StepError> act();
  tl::expected<EncodedPacket, StepError> tick();
};

/// Truth at this tick, as it is before any force of this tick acts.
void Simulation::Impl::observe() {
  frame.tick = world.tick();
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
    frame.objects[i] = world.sample(i);
    true_poses[i] = frame.objects[i].pose;
  }
}

void Simulation::Impl::touch_server() {
  for (std::size_t i = 0; i < users.size(); ++i) {
    User& user = users[i];
    user.touch = user.server.move(user.device.position, user.device.button, true_poses);
    user.rendered = clipped(user.touch.force, user.max_force);
    contacts[i] = user.touch.contact;
  }
}

tl::expected<EncodedPacket, Error> Simulation::Impl::transmit() {
  if (!channel) {
    client_poses = true_poses;
    return EncodedPacket{};
  }
  TACTUS_TRY(const EncodedPacket packet, channel->encoder.encode(frame.tick, frame.objects, contacts));
  if (!packet.bytes.empty()) {
    TACTUS_TRY(const DecodedPacket decoded, channel->decoder.decode(packet.bytes));
    channel->replica.apply(decoded, channel->decoder.objects(), frame.tick);
  }
  for (std::uint32_t i = 0; i < client_poses.size(); ++i)
    client_poses[i] = to_pose(channel->replica.pose(i, frame.tick), header.grid);
  return packet;
}

void Simulation::Impl::touch_client() {
  for (std::size_t i = 0; i < users.size(); ++i) {
    User& user = users[i];
    user.felt = clipped(user.client.move(user.device.position, user.device.button, client_poses).force, user.max_force);
    frame.users[i] = {.contact = user.touch.contact, .force = user.felt, .server_force = user.rendered};
  }
}

tl::expected<void, StepError> Simulation::Impl::act() {
  for (const User& user : users)
    if (user.touch.contact.kind != ContactKind::none) world.push(user.touch.contact.object, -user.rendered, user.touch.proxy);
  return world.step();
}

tl::expected<EncodedPacket, StepError> Simulation::Impl::tick() {
  touch_server();
  const auto packet = transmit();
  if (!packet) return tl::unexpected(StepError{packet.error(), frame.tick, 0});
  touch_client();
  if (const auto moved = act(); !moved) return tl::unexpected(moved.error());
  return *packet;
}

Result<Simulation> Simulation::create(const Scene& scene, const SimulationOptions& options) {
  TACTUS_TRY(StreamHeader header, stream_header(scene));
  auto impl = std::make_unique<Impl>(scene, options.seed, header);
  if (options.channel) {
    TACTUS_TRY(RigidEncoder encoder, RigidEncoder::create(header, options.channel->encoder));
    TACTUS_TRY(RigidDecoder decoder, RigidDecoder::create(header));
    TACTUS_TRY(Replica replica, Replica::create(header, options.channel->replica));
    impl->channel.emplace(Channel{std::move(encoder), std::move(decoder), std::move(replica)});
  }
  Random seeds(options.seed);
  for (const SceneUser& user : scene.users) {
    const Probe probe(scene.objects, *scene.touch);
    impl->users.push_back(User{.hand = Hand(user, options.grip.value_or(user.grip), seeds.next()),
                               .server = probe,
                               .client = probe,
                               .max_force = user.device.max_force,
                               .device = {},
                               .touch = {},
                               .rendered = {},
                               .felt = {}});
  }
  impl->frame.objects.resize(scene.objects.size());
  impl->frame.users.resize(scene.users.size());
  impl->contacts.resize(scene.users.size());
  impl->true_poses.resize(scene.objects.size());
  for (const SceneObject& object : scene.objects) impl->client_poses.push_back(object.pose);
  return Simulation(std::move(impl));
}

tl::expected<EncodedPacket, StepError> Simulation::step() {
  Impl& in = *impl_;
  in.observe();
  for (std::size_t i = 0; i < in.users.size(); ++i) {
    User& user = in.users[i];
    user.device = user.hand.step(user.felt, in.client_poses[in.scene.users[i].object]);
  }
  return in.tick();
}

tl::expected<EncodedPacket, StepError> Simulation::replay(std::span<const UserSample> recorded) {
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
const StreamHeader& Simulation::header() const noexcept { return impl_->header; }

std::int64_t Simulation::ticks() const noexcept { return std::llround(impl_->scene.duration / kTick); }

TraceInfo Simulation::info() const {
  TraceInfo info{.tick_rate = kTickRate, .objects = {}, .users = {}, .source = {}, .scene = impl_->scene.text};
  for (const SceneObject& object : impl_->scene.objects) info.objects.push_back({object.name, object.dof});
  for (const SceneUser& user : impl_->scene.users) info.users.push_back(user.name);
  info.source = "sim " + impl_->scene.name + " seed " + std::to_string(impl_->seed);
  return info;
}

Simulation::Simulation(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

}  // namespace tactus
