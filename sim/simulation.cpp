// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/simulation.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/sim/client.h>
#include <tactus/sim/link/perfect_link.h>
#include <tactus/sim/server.h>
#include <tactus/sim/user/hand.h>
#include <tactus/sim/user/sampled_limit.h>

namespace tactus::sim {

struct Simulation::Impl {
  std::uint64_t seed;
  std::unique_ptr<Server> server;
  std::unique_ptr<Client> client;
  PerfectLink link;
  std::vector<Hand> hands;            // one per user, like the vectors below
  std::vector<DeviceSample> devices;  // of the hands
  std::vector<TouchRecord> records;

  tl::expected<std::span<const Packet>, Diagnostic> refuse(const Error& error) const {
    return tl::unexpected(Diagnostic{.error = error, .step = server->frame().tick});
  }
};

Result<Simulation> Simulation::create(const Scene& scene, const SimulationOptions& options) {
  ServerOptions of_server{options.seed, {}, options.mesh_noise, options.estimate_every};
  if (options.channel) of_server.codec = ServerCodec{options.channel->sender, options.channel->coding};
  auto impl = std::make_unique<Impl>();
  impl->seed = options.seed;
  TACTUS_TRY(impl->server, Server::create(scene, of_server));
  TACTUS_TRY(impl->client, Client::create(*impl->server, options.channel ? options.channel->replica : ReplicaOptions{}));
  Random seeds(options.seed);
  for (const SceneUser& user : scene.users) impl->hands.emplace_back(user, options.grip.value_or(user.grip), seeds.next());
  impl->devices.resize(scene.users.size());
  impl->records.resize(scene.users.size());
  return Simulation(std::move(impl));
}

tl::expected<std::span<const Packet>, Diagnostic> Simulation::step() {
  Impl& in = *impl_;
  for (std::size_t i = 0; i < in.hands.size(); ++i)  // 1
    in.devices[i] = in.hands[i].step(in.client->felt(i), in.client->watched(i));
  return step(in.devices);
}

tl::expected<std::span<const Packet>, Diagnostic> Simulation::step(std::span<const DeviceSample> devices) {
  auto& [seed, server, client, link, hands, own_devices, records] = *impl_;
  if (devices.size() != records.size()) return impl_->refuse(fail(Errc::invalid_argument, "R-API-5").value());
  if (!std::ranges::all_of(devices, [](const DeviceSample& device) { return is_valid(device); }))
    return impl_->refuse(fail(Errc::invalid_argument, "R-API-1").value());

  server->observe();
  server->touch(link.to_server(devices));  // 2
  const auto packets = server->encode();   // 3
  if (!packets) return impl_->refuse(packets.error());
  if (const auto received = client->receive(link.to_client(*packets)); !received) return impl_->refuse(received.error());
  client->show(server->frame());
  client->touch(devices);  // 4
  for (std::size_t i = 0; i < records.size(); ++i) {
    UserSample& user = server->frame().users[i];
    user.force = client->felt(i);
    records[i].add(user);
  }
  TACTUS_CHECK(server->step());  // 5
  return *packets;
}

const TraceFrame& Simulation::frame() const noexcept { return impl_->server->frame(); }
std::span<const Pose> Simulation::client_poses() const noexcept { return impl_->client->poses(); }
const DeformableObjects* Simulation::deformables() const noexcept { return impl_->server->deformables(); }
const TouchSummary& Simulation::touched(std::size_t user) const noexcept { return impl_->records[user].summary(); }
Replica& Simulation::replica() noexcept { return impl_->client->replica(); }
SharedScene Simulation::stream_scene() const noexcept { return impl_->server->stream_scene(); }

double Simulation::bears(std::size_t user) const noexcept {
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
