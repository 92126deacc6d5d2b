// SPDX-License-Identifier: Apache-2.0
/// The network between a server and one client per user, in virtual time: a session with each, over emulated links.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tactus/base/device_sample.h>
#include <tactus/session/session_client.h>
#include <tactus/session/session_server.h>
#include <tactus/sim/link/link.h>
#include <tactus/sim/link/network.h>

namespace tactus::sim {

struct NetworkOptions {
  LinkOptions uplink, downlink;  ///< of user 0; those of others differ by their seeds
  DeviceCoding device{};
  PlayoutOptions playout{};
  Role role = Role::participant;  ///< of every client
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
  View view(std::size_t user) noexcept override;

  SessionClient& client(std::size_t user) noexcept { return *users_[user].client; }
  SessionStatus status(std::size_t user) const noexcept { return users_[user].client->status(); }
  SessionServer& server() noexcept { return *server_; }
  std::uint64_t now() const noexcept { return now_; }  ///< [us] on the clock of both ends
  /// Counters of the links since tick 0.
  const LinkCounters& uplink(std::size_t user) const noexcept { return users_[user].up->counters(); }
  const LinkCounters& downlink(std::size_t user) const noexcept { return users_[user].down->counters(); }
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
  void deliver() noexcept;
  void advance(std::uint64_t until) noexcept;
  std::uint64_t time_of(std::int64_t tick) const noexcept;
  Microseconds link_time() const noexcept { return static_cast<Microseconds>(now_ - links_since_); }

  std::unique_ptr<SessionServer> server_;
  std::vector<User> users_;
  std::vector<DeviceSample> heard_;
  std::uint64_t now_ = 1'000'000, links_since_ = now_;
  std::uint64_t start_ = 0;  // [us] of tick 0
  std::uint64_t tick_rate_ = 1000;
  bool begun_ = false;
};

}  // namespace tactus::sim
