// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/link/session_network.h>

#include <algorithm>
#include <utility>

#include <tactus/base/rule.h>
#include <tactus/sim/random.h>

namespace tactus::sim {
namespace {

constexpr std::uint64_t kTimeout = 60'000'000, kLook = 10'000, kFarewell = 1'000'000;  // [us]

Traffic difference(const Traffic& now, const Traffic& before) noexcept {
  Traffic out = now;
  out.datagrams_sent -= before.datagrams_sent;
  out.bytes_sent -= before.bytes_sent;
  out.packets_sent -= before.packets_sent;
  out.payload_sent -= before.payload_sent;
  out.datagrams_heard -= before.datagrams_heard;
  out.bytes_heard -= before.bytes_heard;
  out.packets_heard -= before.packets_heard;
  out.payload_heard -= before.payload_heard;
  out.packets_refused -= before.packets_refused;
  out.packets_held -= before.packets_held;
  out.lost -= before.lost;
  out.ticks_held -= before.ticks_held;
  out.wrong_states -= before.wrong_states;
  return out;
}

}  // namespace

Result<std::unique_ptr<SessionNetwork>> SessionNetwork::create(SharedScene scene, std::size_t users, const SenderOptions& sender,
                                                               const NetworkOptions& options) {
  std::unique_ptr<SessionNetwork> network(new SessionNetwork);
  network->tick_rate_ = scene->tick_rate;
  network->observer_ = options.observer;
  Random seeds(options.downlink.seed);
  const SessionServerOptions of_server{.sender = sender,
                                       .loss = options.loss,
                                       .clients = static_cast<std::uint16_t>(std::max<std::size_t>(1, users)),
                                       .rate = options.rate};
  TACTUS_TRY(auto server, SessionServer::create(std::move(scene), of_server, seeds.next(), network->now_));
  network->server_ = std::make_unique<SessionServer>(std::move(server));
  for (std::size_t i = 0; i < users; ++i) {
    const SessionClientOptions of_client{.role = options.role, .playout = options.playout, .device = options.device};
    TACTUS_TRY(auto client, SessionClient::create(of_client));
    network->users_.push_back({std::make_unique<SessionClient>(std::move(client)), {}, {}, 0, {}, {}});
    network->users_.back().client->open(network->now_, seeds.next());
  }
  network->heard_.resize(users);
  NetworkOptions before = options;
  for (LinkOptions* link : {&before.uplink, &before.downlink}) {
    link->outages.clear();
    link->recorded.clear();
  }
  TACTUS_CHECK(network->lay_links(before));
  TACTUS_CHECK(network->connect());
  TACTUS_CHECK(network->lay_links(options));
  return network;
}

static Result<void> lay(std::optional<Link>& link, const LinkOptions& options, Microseconds now) {
  if (link) return link->restart(options, now);
  TACTUS_TRY(link, Link::create(options));
  return {};
}

Result<void> SessionNetwork::lay_links(const NetworkOptions& options) {
  const Microseconds since = link_time();
  links_since_ = now_;
  for (std::size_t i = 0; i < users_.size(); ++i) {
    LinkOptions up = options.uplink, down = options.downlink;
    up.seed += 2 * i + 1;
    down.seed += 2 * i;
    TACTUS_CHECK(lay(users_[i].up, up, since));
    TACTUS_CHECK(lay(users_[i].down, down, since));
  }
  return {};
}

Result<void> SessionNetwork::connect() {
  const auto all_live = [&] {
    return std::ranges::all_of(users_, [&](const User& user) {
      const SessionStatus status = user.client->status();
      return status.state == SessionState::live && status.round_trip &&
             server_->status(status.client).state == SessionState::live;
    });
  };
  drain();
  for (const std::uint64_t end = now_ + kTimeout; !all_live(); advance(now_ + kLook))
    if (now_ >= end) return fail(Errc::state, "R-SIM-7");
  for (User& user : users_) {
    user.number = user.client->status().client;
    user.up_before = user.client->status().traffic;
    user.down_before = server_->status(user.number).traffic;
  }
  start_ = now_;
  return {};
}

void SessionNetwork::show(Sighting::CapturePoint point, std::size_t user, std::span<const std::uint8_t> datagram) const noexcept {
  if (observer_) observer_({point, user, now_, datagram});
}

void SessionNetwork::drain() noexcept {
  while (const auto datagram = server_->poll_datagram(now_)) {
    const std::size_t user = datagram->peer - 1;
    show(Sighting::CapturePoint::server_sends, user, datagram->bytes);
    users_[user].down->send(link_time(), datagram->bytes);
  }
  while (server_->poll_event()) continue;
  for (std::size_t i = 0; i < users_.size(); ++i) {
    while (const auto datagram = users_[i].client->poll_datagram(now_)) {
      show(Sighting::CapturePoint::client_sends, i, *datagram);
      users_[i].up->send(link_time(), *datagram);
    }
    while (users_[i].client->poll_event()) continue;
  }
}

void SessionNetwork::deliver() noexcept {
  for (std::size_t i = 0; i < users_.size(); ++i) {
    while (const auto arrival = users_[i].up->poll(link_time())) {
      show(Sighting::CapturePoint::server_hears, i, arrival->bytes);
      static_cast<void>(server_->handle_datagram(now_, i + 1, arrival->bytes));
    }
    while (const auto arrival = users_[i].down->poll(link_time())) {
      show(Sighting::CapturePoint::client_hears, i, arrival->bytes);
      static_cast<void>(users_[i].client->handle_datagram(now_, arrival->bytes));
    }
    users_[i].client->handle_timeout(now_);
  }
  server_->handle_timeout(now_);
}

/// All that happens up to a time, each at its own.
void SessionNetwork::advance(std::uint64_t until) noexcept {
  for (;;) {
    std::uint64_t next = server_->next_timeout().value_or(until);
    for (const User& user : users_) {
      next = std::min(next, user.client->next_timeout().value_or(until));
      for (const auto& link : {user.up->next(), user.down->next()})
        if (link) next = std::min(next, links_since_ + static_cast<std::uint64_t>(*link));
    }
    if (next > until) break;
    now_ = std::max(now_ + (next <= now_ ? 1 : 0), next);  // a timeout that is due and has nothing to send waits
    if (now_ > until) break;
    deliver();
    drain();
  }
  now_ = until;
  deliver();
  drain();
}

std::uint64_t SessionNetwork::time_of(std::int64_t tick) const noexcept {
  return start_ + 1'000'000 * static_cast<std::uint64_t>(tick) / tick_rate_;
}

Result<void> SessionNetwork::to_server(std::int64_t tick, std::span<const DeviceSample> devices,
                                       std::span<const std::optional<DeviceContact>> contacts) {
  if (!std::exchange(begun_, true)) std::ranges::copy(devices, heard_.begin());
  advance(time_of(tick));
  for (std::size_t i = 0; i < devices.size(); ++i) TACTUS_CHECK(users_[i].client->submit(now_, devices[i], contacts[i]));
  drain();
  deliver();
  drain();
  for (std::size_t i = 0; i < users_.size(); ++i) heard_[i] = server_->device(users_[i].number, now_).value_or(heard_[i]);
  return {};
}

Result<void> SessionNetwork::to_clients(std::int64_t tick, const Truth& truth) {
  TACTUS_CHECK(server_->submit(now_, tick, truth));
  drain();
  deliver();
  drain();
  return {};
}

void SessionNetwork::leave() noexcept {
  for (User& user : users_) user.client->close();
  drain();
  advance(now_ + kFarewell);
}

Network::View SessionNetwork::view(std::size_t user) noexcept {
  SessionClient& client = *users_[user].client;
  const std::uint64_t delay = client.round_trip_shown(now_).value_or(0);
  return {client.receiver(), client.shown_tick(now_), client.force_fraction(now_),
          static_cast<std::uint32_t>((delay * tick_rate_ + 500'000) / 1'000'000)};
}

Traffic SessionNetwork::sent_to(std::size_t user) const noexcept {
  return difference(server_->status(users_[user].number).traffic, users_[user].down_before);
}

Traffic SessionNetwork::sent_by(std::size_t user) const noexcept {
  return difference(users_[user].client->status().traffic, users_[user].up_before);
}

}  // namespace tactus::sim
