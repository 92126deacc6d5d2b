// SPDX-License-Identifier: Apache-2.0
#include "cli/live/serve_check.h"

#include <malloc.h>

#include <cmath>
#include <fstream>
#include <string>

#include <fmt/format.h>

#include <tactus/device/real_time.h>
#include <tactus/session/session_client.h>
#include "cli/live/live_report.h"
#include "cli/report/json.h"

namespace tactus::cli {
namespace {

/// [bytes] That this program has touched: ends reserve more than they use. 0 where the system does not report it.
std::size_t resident() {
  std::ifstream status("/proc/self/status");
  std::size_t kilobytes = 0;
  for (std::string word; kilobytes == 0 && status >> word;)
    if (word == "VmRSS:") status >> kilobytes;
  return 1024 * kilobytes;
}

/// What was freed goes back to the system, so that pages that are taken again count.
void give_back() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

/// Each object to and fro by a centimetre along the first axis that is free.
void shake(const tactus::Scene& scene, const Truth& truth, std::int64_t tick, std::vector<RigidSample>& out) {
  out.assign(truth.objects.begin(), truth.objects.end());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double angle = 0.006 * static_cast<double>(tick) + static_cast<double>(i), displacement = 0.01 * std::sin(angle);
    const unsigned dof = scene.objects[i].dof;
    Vec3& position = out[i].pose.position;
    if ((dof & 1u) != 0) position.x += displacement;
    else if ((dof & 2u) != 0) position.y += displacement;
    else if ((dof & 4u) != 0) position.z += displacement;
  }
}

/// A server and a client that joins it, a millisecond after the other.
class Trial {
 public:
  Trial(SessionServer server, SessionClient client) : server_(std::move(server)), client_(std::move(client)) {
    client_.open(now_, 1);
    give_back();
  }

  /// in   shakes  all objects move: what is kept for each is in use
  void step(sim::Server& world, bool shakes = false) {
    constexpr std::uint64_t kPeer = 1;
    now_ += 1000;
    while (const auto datagram = client_.poll_datagram(now_))
      count([&] { static_cast<void>(server_.handle_datagram(now_, kPeer, *datagram)); });
    world.frame().tick = tick_++;
    Truth truth = world.truth();
    if (shakes) shake(*world.stream_scene(), truth, tick_, moving_);
    if (shakes) truth.objects = moving_;
    count([&] { static_cast<void>(server_.submit(now_, world.frame().tick, truth)); });
    while (true) {
      std::optional<SessionServer::Transmit> datagram;
      count([&] { datagram = server_.poll_datagram(now_); });
      if (!datagram) break;
      static_cast<void>(client_.handle_datagram(now_, datagram->bytes));
    }
    client_.handle_timeout(now_);
    while (const auto event = client_.poll_event())
      if (event->kind == ClientEvent::Kind::closed) closed_ = event->reason;
  }
  SessionStatus status() const { return client_.status(); }
  bool is_live() const { return server_.status(0).state == SessionState::live; }  ///< at both ends
  std::optional<LeaveReason> closed() const { return closed_; }
  std::size_t memory() const { return memory_; }  ///< [bytes] that the server uses for it

 private:
  template <class Work>
  void count(const Work& work) {
    const std::size_t before = resident();
    work();
    memory_ += resident() - before;  // what was given back comes off again
  }

  SessionServer server_;
  SessionClient client_;
  std::uint64_t now_ = 1'000'000;  // [us]
  std::int64_t tick_ = 0;
  std::optional<LeaveReason> closed_;
  std::vector<RigidSample> moving_;
  std::size_t memory_ = 0;
};

tl::expected<Trial, Failure> join(const ServePlan& plan, sim::Server& world) {
  constexpr int kMost = 600'000;  // [ms]: a declaration of some 100 MB
  constexpr int kShaken = 300;    // [ms]
  auto server = SessionServer::create(world.stream_scene(), plan.settings, 1, 1'000'000);
  if (!server) return refuse(plan.scene, server.error());
  const bool has_user = !world.scene().users.empty();
  auto client = SessionClient::create({.role = has_user ? Role::participant : Role::observer, .limits = plan.limits});
  if (!client) return refuse(plan.scene, client.error());
  Trial trial(std::move(*server), std::move(*client));
  world.observe();
  for (int i = 0; i < kMost && !trial.is_live() && !trial.closed(); ++i) trial.step(world);
  if (trial.closed())
    return refuse(fmt::format("{}: a client with these limits does not join: {}", plan.scene, cli::name_of(*trial.closed())),
                  "Allow more memory or a longer declaration with --limit, here and at each client, or make the scene smaller.");
  if (!trial.is_live())
    return refuse(fmt::format("{}: a client has only {} of {} bytes of the scene after 10 min", plan.scene,
                              trial.status().received, trial.status().declaration),
                  "Raise --rate, or make the scene smaller.");
  for (int i = 0; i < kShaken; ++i) trial.step(world, true);
  return trial;
}

Json privileges_json() {
  Json out = Json::array();
  const device::RealTime real_time;
  for (const device::Privilege& privilege : real_time.privileges())
    out.push_back({{"name", privilege.name}, {"granted", privilege.granted}, {"remedy", privilege.remedy}});
  return out;
}

/// What would help where there is less than was asked for.
std::string room_remedy(const ServePlan& plan) {
  if (plan.room >= plan.wanted_room) return {};
  return fmt::format("allow it: `sysctl -w net.core.rmem_max={}`", plan.wanted_room);
}

}  // namespace

tl::expected<Value, Failure> check_plan(const ServePlan& plan, sim::Server& world) {
  TACTUS_TRY(const Trial trial, join(plan, world));
  const tactus::Scene& scene = *world.stream_scene();
  std::size_t vertices = 0;
  for (const auto& deformable : scene.deformables) vertices += deformable.rest.size();
  Json out{{"schema", "tactus.serve_check/1"},
           {"scene", plan.scene},
           {"listen", plan.listen},
           {"sealed", plan.is_sealed},
           {"objects", scene.objects.size()},
           {"meshes", scene.deformables.size()},
           {"vertices", vertices},
           {"users", Json::array()},
           {"declaration_bytes", trial.status().declaration},
           {"clients", plan.settings.clients}};
  for (const sim::SceneUser& user : world.scene().users) out["users"].push_back(user.name);
  if (trial.memory() > 0) {
    out["memory_per_client_bytes"] = trial.memory();
    out["memory_of_clients_bytes"] = trial.memory() * plan.settings.clients;
  }
  out["system"] = privileges_json();
  out["system"].push_back(
      {{"name", "room for datagrams"}, {"granted", plan.room >= plan.wanted_room}, {"remedy", room_remedy(plan)}});
  return Value(std::move(out));
}

}  // namespace tactus::cli
