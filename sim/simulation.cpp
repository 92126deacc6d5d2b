// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/simulation.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/sim/client.h>
#include <tactus/sim/link/link.h>
#include <tactus/sim/server.h>
#include <tactus/sim/user/hand.h>
#include <tactus/sim/user/passivity.h>

namespace tactus::sim {
namespace {

constexpr double kStill = 5e-3;  // [m/s] a hand whose aim is slower holds still

}  // namespace

struct Simulation::Impl {
  std::uint64_t seed;
  Client& client(std::size_t user) noexcept { return *clients[clients.size() > 1 ? user : 0]; }
  void move_hands(std::size_t but) noexcept;
  Result<std::span<const Packet>> travel(std::span<const DeviceSample> at_clients) noexcept;
  void render(std::span<const DeviceSample> at_clients) noexcept;

  std::unique_ptr<Server> server;
  std::unique_ptr<Network> network;              // null: a perfect link
  std::vector<std::unique_ptr<Client>> clients;  // with a network one per user
  PerfectLink link;
  std::vector<std::optional<DeviceContact>> contacts;  // of the devices, in the tick before
  std::vector<std::int64_t> shown;                     // tick, at each user's client
  std::vector<double> fractions;                       // of the force that it renders
  std::vector<std::uint32_t> delays;                   // [ticks] of what it shows
  std::vector<Hand> hands;                             // one per user, like the vectors below
  std::vector<DeviceSample> devices;                   // of the hands
  std::vector<TouchRecord> records;
  std::vector<TouchRecord::Aim> aims;  // of the hands, in this tick

  tl::expected<std::span<const Packet>, Diagnostic> refuse(const Error& error) const {
    return tl::unexpected(Diagnostic{.error = error, .step = server->frame().tick});
  }
};

Result<Simulation> Simulation::create(const Scene& scene, const SimulationOptions& options) {
  ServerOptions of_server{options.seed, {}, options.mesh_noise, options.estimate_every, options.parts};
  const bool is_remote = options.channel && options.channel->network;
  if (options.channel)
    of_server.codec = ServerCodec{options.channel->sender, options.channel->coding, is_remote,
                                  options.channel->client_model_scale, options.channel->limits};
  auto impl = std::make_unique<Impl>();
  impl->seed = options.seed;
  TACTUS_TRY(impl->server, Server::create(scene, of_server));
  if (is_remote) {
    TACTUS_TRY(impl->network,
               options.channel->network(impl->server->stream_scene(), scene.users.size(), options.channel->sender));
    for (std::size_t i = 0; i < scene.users.size(); ++i) {
      TACTUS_TRY(auto client, Client::create_remote(*impl->server, i, options.channel->own ? *options.channel->own : scene));
      if (options.channel->timed) client->measure();
      impl->clients.push_back(std::move(client));
    }
  } else {
    impl->clients.emplace_back();
    TACTUS_TRY(impl->clients[0], Client::create(*impl->server, options.channel ? options.channel->replica : ReplicaOptions{}));
  }
  for (std::size_t i = 0; i < scene.users.size(); ++i) {
    const SceneUser& user = scene.users[i];
    impl->hands.emplace_back(user, options.grip.value_or(user.grip), hand_seed(options.seed, i));
  }
  impl->devices.resize(scene.users.size());
  impl->records.resize(scene.users.size());
  impl->aims.assign(scene.users.size(), TouchRecord::Aim::unknown);
  impl->contacts.resize(scene.users.size());
  impl->shown.assign(scene.users.size(), -1);
  impl->fractions.assign(scene.users.size(), 1);
  impl->delays.assign(scene.users.size(), 0);
  return Simulation(std::move(impl));
}

/// Step 1, but for the hand of this user.
void Simulation::Impl::move_hands(std::size_t but) noexcept {
  for (std::size_t i = 0; i < hands.size(); ++i)
    if (i != but) {
      devices[i] = hands[i].step(client(i).rendered_force(i), client(i).watched(i));
      aims[i] = hands[i].aim_speed() < kStill ? TouchRecord::Aim::rests : TouchRecord::Aim::moves;
    }
}

tl::expected<std::span<const Packet>, Diagnostic> Simulation::step() {
  impl_->move_hands(SIZE_MAX);
  return step(impl_->devices);
}

tl::expected<std::span<const Packet>, Diagnostic> Simulation::step(std::size_t user, const DeviceSample& device) {
  impl_->move_hands(user);
  impl_->devices[user] = device;
  return step(impl_->devices);
}

/// Steps 2 and 3: the devices go to the server, its packets to the clients.
Result<std::span<const Packet>> Simulation::Impl::travel(std::span<const DeviceSample> at_clients) noexcept {
  const std::int64_t tick = server->frame().tick;
  if (!network) {
    server->touch(link.to_server(at_clients));
    TACTUS_TRY(const auto packets, server->encode());
    TACTUS_CHECK(clients[0]->receive(link.to_client(packets)));
    return packets;
  }
  TACTUS_CHECK(network->to_server(tick, at_clients, contacts));
  server->touch(network->heard());
  TACTUS_CHECK(network->to_clients(tick, server->truth()));
  return std::span<const Packet>();
}

/// Step 4.
void Simulation::Impl::render(std::span<const DeviceSample> at_clients) noexcept {
  if (!network) {
    clients[0]->show(server->frame());
    return clients[0]->touch(at_clients);
  }
  for (std::size_t i = 0; i < clients.size(); ++i) {
    const Network::View view = network->view(i);
    shown[i] = view.tick;
    fractions[i] = view.force_fraction;
    delays[i] = view.delay;
    if (view.tick >= 0) clients[i]->show(*view.receiver, view.tick);
    else clients[i]->show_nothing();
    clients[i]->touch(i, at_clients[i], {view.force_fraction, view.delay});
    contacts[i] = clients[i]->contact(i);
  }
}

tl::expected<std::span<const Packet>, Diagnostic> Simulation::step(std::span<const DeviceSample> devices) {
  Impl& in = *impl_;
  if (devices.size() != in.records.size()) return in.refuse(fail(Errc::invalid_argument, "R-API-5").value());
  if (!std::ranges::all_of(devices, [](const DeviceSample& device) { return is_valid(device); }))
    return in.refuse(fail(Errc::invalid_argument, "R-API-1").value());

  in.server->observe();
  const auto packets = in.travel(devices);  // 2, 3
  if (!packets) return in.refuse(packets.error());
  in.render(devices);  // 4
  for (std::size_t i = 0; i < in.records.size(); ++i) {
    UserSample& user = in.server->frame().users[i];
    user.force = in.client(i).rendered_force(i);
    in.records[i].add(user, std::exchange(in.aims[i], TouchRecord::Aim::unknown));
  }
  TACTUS_CHECK(in.server->step());  // 5
  return *packets;
}

std::span<const HeldPart> Simulation::held() const noexcept {
  return impl_->network ? impl_->network->held() : impl_->server->held();
}

const TraceFrame& Simulation::frame() const noexcept { return impl_->server->frame(); }
std::span<const Pose> Simulation::client_poses() const noexcept { return impl_->client(0).poses(); }
std::span<const Pose> Simulation::received_poses(std::size_t user) const noexcept { return impl_->client(user).received(); }
const Pose& Simulation::watched(std::size_t user) const noexcept { return impl_->client(user).watched(user); }
std::int64_t Simulation::shown_tick(std::size_t user) const noexcept {
  return impl_->network ? impl_->shown[user] : impl_->server->frame().tick;
}
double Simulation::rendered_fraction(std::size_t user) const noexcept {
  return impl_->contacts[user] ? impl_->fractions[user] : 1;
}
double Simulation::round_trip(std::size_t user) const noexcept { return kTick * impl_->delays[user]; }
double Simulation::stiffness(std::size_t user) const noexcept { return impl_->client(user).stiffness(user); }
std::optional<Vec3> Simulation::touched_point(std::size_t user) const noexcept {
  const auto& contact = impl_->client(user).contact(user);
  return contact ? std::optional(contact->proxy) : std::nullopt;
}
const RigidErrors& Simulation::rigid_errors() const noexcept { return std::as_const(*impl_->server).rigid().errors(); }

void Simulation::energies(std::vector<double>& out) noexcept {
  Server& server = *impl_->server;
  out.clear();
  for (std::uint32_t i = 0; i < server.scene().objects.size(); ++i) out.push_back(server.rigid().energy(i));
  for (std::size_t i = 0; i < server.scene().deformables.size(); ++i) out.push_back(server.deformables()->energy(i));
}

const DeformableObjects* Simulation::deformables() const noexcept { return impl_->server->deformables(); }
const ClientCosts& Simulation::client_costs(std::size_t user) const noexcept { return impl_->client(user).costs(); }
const TouchSummary& Simulation::touched(std::size_t user) const noexcept { return impl_->records[user].summary(); }
Replica& Simulation::replica() noexcept { return impl_->client(0).replica(); }
SharedScene Simulation::stream_scene() const noexcept { return impl_->server->stream_scene(); }

double Simulation::tolerated_stiffness(std::size_t user) const noexcept {
  return sampled_limit(impl_->hands[user].impedance(), impl_->server->scene().users[user].device);
}

std::int64_t Simulation::ticks() const noexcept { return std::llround(impl_->server->scene().duration / kTick); }

TraceInfo Simulation::info() const {
  TraceInfo info = impl_->server->info();
  info.source = "sim " + impl_->server->scene().name + " seed " + std::to_string(impl_->seed);
  return info;
}

Simulation::Simulation(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

}  // namespace tactus::sim
