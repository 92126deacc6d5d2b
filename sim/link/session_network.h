// SPDX-License-Identifier: Apache-2.0
/// The network between a server and one client per user, in virtual time: a session with each, over emulated links.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tactus/base/geometry.h>
#include <tactus/session/session_client.h>
#include <tactus/session/session_server.h>
#include <tactus/sim/link/link.h>

namespace tactus::sim {

/// A datagram at an end: when the end hands it to the network, or when it comes out of it there.
struct Sighting {
  enum class CapturePoint : std::uint8_t { client_sends, client_hears, server_sends, server_hears };
  CapturePoint point = CapturePoint::client_sends;
  std::size_t user = 0;    ///< of the client
  std::uint64_t time = 0;  ///< [us] on the clock of both ends; never falls
  std::span<const std::uint8_t> datagram;
};

struct NetworkOptions {
  LinkOptions uplink, downlink;  ///< of user 0; those of others differ by their seeds
  DeviceCoding device{};
  PlayoutOptions playout{};
  Role role = Role::participant;          ///< of every client
  std::uint64_t rate = 0;                 ///< [bit/s] at most, to each client; 0: no limit
  LossPolicy loss = LossPolicy::by_role;  ///< of the server
  /// Sees each datagram at both ends, from the first join on. It may not throw.
  std::function<void(const Sighting&)> observer{};
};

class SessionNetwork final : public Network {
 public:
  /// Let the sessions begin, before tick 0, over links as they will be but for their outages and recorded delays.
  /// in   users  number of clients
  /// err  of SessionServer::create, SessionClient::create, Link::create; state R-SIM-7: after a minute not all are live
  static Result<std::unique_ptr<SessionNetwork>> create(SharedScene scene, std::size_t users, const SenderOptions& sender,
                                                        const NetworkOptions& options);

  Result<void> to_server(std::int64_t tick, std::span<const DeviceSample> devices,
                         std::span<const std::optional<DeviceContact>> contacts) override;  ///< err  of SessionClient::submit
  std::span<const DeviceSample> heard() const noexcept override { return heard_; }
  Result<void> to_clients(std::int64_t tick, const Truth& truth) override;  ///< err  of SessionServer::submit
  std::span<const HeldPart> held() const noexcept override { return server_->held(); }
  View view(std::size_t user) noexcept override;
  /// The clients end their sessions, and a second passes.
  void leave() noexcept;

  SessionClient& client(std::size_t user) noexcept { return *users_[user].client; }
  /// The offset is that of the clock of both ends, which is one, not of that which the server signals.
  SessionStatus status(std::size_t user) const noexcept {
    SessionStatus out = users_[user].client->status();
    if (out.clock_offset) *out.clock_offset += static_cast<std::int64_t>(now_ - server_->clock(now_));
    return out;
  }
  SessionServer& server() noexcept { return *server_; }
  std::uint64_t now() const noexcept { return now_; }      ///< [us] on the clock of both ends
  std::uint64_t start() const noexcept { return start_; }  ///< [us] of tick 0
  /// Counters of the links since tick 0.
  const LinkCounters& uplink(std::size_t user) const noexcept { return users_[user].up->counters(); }
  const LinkCounters& downlink(std::size_t user) const noexcept { return users_[user].down->counters(); }
  BoundScaling bound_scaling(std::size_t user) const noexcept { return server_->status(users_[user].number).bound_scaling; }
  Traffic sent_to(std::size_t user) const noexcept;  ///< by the server, since tick 0
  Traffic sent_by(std::size_t user) const noexcept;  ///< by the client, since tick 0

 private:
  struct User {
    std::unique_ptr<SessionClient> client;
    std::optional<Link> up, down;
    std::uint16_t number = 0;  // at the server
    Traffic up_before, down_before;
  };
  SessionNetwork() = default;
  Result<void> lay_links(const NetworkOptions& options);
  Result<void> connect();
  void drain() noexcept;
  void show(Sighting::CapturePoint point, std::size_t user, std::span<const std::uint8_t> datagram) const noexcept;
  void deliver() noexcept;
  void advance(std::uint64_t until) noexcept;
  std::uint64_t time_of(std::int64_t tick) const noexcept;
  Microseconds link_time() const noexcept { return static_cast<Microseconds>(now_ - links_since_); }

  std::unique_ptr<SessionServer> server_;
  std::vector<User> users_;
  std::vector<DeviceSample> heard_;
  std::function<void(const Sighting&)> observer_;
  std::uint64_t now_ = 1'000'000, links_since_ = now_;
  std::uint64_t start_ = 0;  // [us] of tick 0
  std::uint64_t tick_rate_ = 1000;
  bool begun_ = false;
};

}  // namespace tactus::sim
