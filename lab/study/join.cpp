// SPDX-License-Identifier: Apache-2.0
#include "lab/study/join.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include <tactus/scene/scene_builder.h>
#include <tactus/scene/scene_syntax.h>
#include <tactus/session/session_client.h>
#include <tactus/session/session_server.h>
#include <tactus/sim/link/link.h>

namespace tactus::sim::study {
namespace {

constexpr std::uint64_t kTick = 1000, kStart = 1'000'000, kLongest = 600'000'000;  // [us]
constexpr std::uint32_t kBodies = 10;
constexpr std::size_t kLooker = 0, kJoiner = 1;

TriMesh sheet(std::uint32_t side) {
  TriMesh out;
  for (std::uint32_t y = 0; y < side; ++y)
    for (std::uint32_t x = 0; x < side; ++x) out.vertices.push_back({1e-3 * x, 1e-3 * y, 1e-4 * std::sin(0.1 * x * y)});
  for (std::uint32_t y = 0; y + 1 < side; ++y)
    for (std::uint32_t x = 0; x + 1 < side; ++x) {
      const std::uint32_t a = y * side + x;
      out.triangles.push_back({a, a + 1, a + side + 1});
      out.triangles.push_back({a, a + side + 1, a + side});
    }
  return out;
}

/// A live client that looks at bodies that swing, and one that joins; a line that both share. On the line a datagram has a tag, within what
/// a seal takes: the time at which it went, and its client.
class Line {
 public:
  static Result<Line> create(const JoinCase& of) {
    SceneBuilder builder(1000);
    for (std::uint32_t i = 0; i < kBodies; ++i) builder.rigid("body " + std::to_string(i), {{0.1 * i, 0, 0}, {}});
    builder.deformable("sheet", sheet(of.side), {.frame_period = 17});
    TACTUS_TRY(auto scene, builder.baselines(64).build());
    TACTUS_TRY(const auto declaration, write_scene(*scene));
    SessionServerOptions options;
    options.clients = 2;
    options.rate = of.limit;
    options.addresses_are_validated = of.sealed;
    options.sender.triggers = {.visual_position = 6e-3, .haptic = HapticRule::off};
    TACTUS_TRY(auto server, SessionServer::create(std::move(scene), options, of.seed, kStart));
    Line out(std::move(server));
    out.tag_ = of.sealed ? 29 : 9;
    out.pieces_ = (declaration.size() + 1023) / 1024;
    out.result_.declaration = declaration.size();
    TACTUS_CHECK(out.lay(of));
    for (std::optional<SessionClient>& client : out.clients_) {
      TACTUS_TRY(client, SessionClient::create({.role = Role::observer}));
    }
    return out;
  }

  Result<JoinResult> run() {
    clients_[kLooker]->open(now_, 1);
    while (!is_live(kLooker) && now_ < kLongest) TACTUS_CHECK(step());
    for (const std::uint64_t settled = now_ + 3'000'000; now_ < settled;) TACTUS_CHECK(step());
    measures_ = true;
    const std::uint64_t joins = now_;
    clients_[kJoiner]->open(now_, 2);
    std::uint64_t had = 0, moved = now_;
    while (!is_live(kJoiner) && now_ < joins + kLongest) {
      TACTUS_CHECK(step());
      const std::uint64_t has = clients_[kJoiner]->status().received;
      result_.longest_silence = std::max(result_.longest_silence, 1e-6 * static_cast<double>(now_ - moved));
      if (has != had || is_live(kJoiner)) had = has, moved = now_;
    }
    const auto live = now_;
    if (is_live(kJoiner)) result_.live = 1e-6 * static_cast<double>(live - joins);
    measures_ = false;
    while (now_ < live + 1'000'000) TACTUS_CHECK(step());  // what is on its way
    return finish();
  }

 private:
  explicit Line(SessionServer server) : server_(std::move(server)) {}

  Result<void> lay(const JoinCase& of) {
    LinkOptions link{.seed = 2 * of.seed, .delay = of.round_trip / 2, .jitter = of.jitter, .loss = of.loss};
    TACTUS_TRY(up_, Link::create(link));
    link.seed += 1;
    link.rate = of.rate;
    link.queue = static_cast<std::size_t>(std::max(1600.0, of.rate / 8e6 * static_cast<double>(of.queue)));
    TACTUS_TRY(down_, Link::create(link));
    return {};
  }
  bool is_live(std::size_t client) const { return clients_[client]->status().state == SessionState::live; }
  Microseconds line_time() const { return static_cast<Microseconds>(now_ - kStart); }

  /// To the next moment at which anything happens.
  Result<void> step() {
    std::uint64_t next = tick_at_;
    if (const auto due = server_.next_timeout()) next = std::min(next, *due);
    for (const auto& client : clients_)
      if (const auto due = client->next_timeout()) next = std::min(next, *due);
    for (const auto& due : {up_->next(), down_->next()})
      if (due) next = std::min(next, kStart + static_cast<std::uint64_t>(*due));
    now_ = std::max(now_, next);
    deliver();
    if (now_ >= tick_at_) {
      if (is_live(kLooker)) TACTUS_CHECK(tick());
      tick_at_ = now_ + kTick;
    }
    server_.handle_timeout(now_);
    for (auto& client : clients_) client->handle_timeout(now_);
    send();
    return {};
  }

  Result<void> tick() {
    const double time = 1e-3 * static_cast<double>(tick_);
    for (std::uint32_t i = 0; i < kBodies; ++i) {
      const double rate = 3 + 0.5 * i;
      bodies_[i].pose.position = {0.1 * i, 0.05 * std::sin(rate * time), 0};
      bodies_[i].velocity = {0, 0.05 * rate * std::cos(rate * time), 0};
    }
    return server_.submit(now_, tick_++, {.objects = bodies_});
  }

  void deliver() {
    while (const auto arrival = up_->poll(line_time())) {
      const auto [datagram, time, client] = untagged(arrival->bytes);
      static_cast<void>(server_.handle_datagram(now_, client + 1, datagram));
    }
    while (const auto arrival = down_->poll(line_time())) {
      const auto [datagram, time, client] = untagged(arrival->bytes);
      if (client == kLooker && measures_) took_.push_back(1e-6 * static_cast<double>(now_ - time));
      static_cast<void>(clients_[client]->handle_datagram(now_, datagram));
    }
  }

  void send() {
    while (const auto datagram = server_.poll_datagram(now_)) {
      const std::size_t client = datagram->peer - 1;
      const std::uint64_t dropped = down_->counters().overflowed;
      put(*down_, client, datagram->bytes);
      if (!measures_) continue;
      ++sent_[client];
      dropped_[client] += down_->counters().overflowed - dropped;
    }
    for (std::size_t i = 0; i < clients_.size(); ++i)
      while (const auto datagram = clients_[i]->poll_datagram(now_)) put(*up_, i, *datagram);
    while (server_.poll_event()) continue;
    for (auto& client : clients_)
      while (client->poll_event()) continue;
  }

  void put(Link& link, std::size_t client, std::span<const std::uint8_t> datagram) {
    bytes_.assign(datagram.begin(), datagram.end());
    bytes_.resize(datagram.size() + tag_ - 1);
    std::memcpy(&bytes_[datagram.size()], &now_, 8);
    bytes_.push_back(static_cast<std::uint8_t>(client));
    link.send(line_time(), bytes_);
  }
  struct Tagged {
    std::span<const std::uint8_t> datagram;
    std::uint64_t time = 0;
    std::size_t client = 0;
  };
  Tagged untagged(std::span<const std::uint8_t> bytes) const {
    Tagged out{bytes.first(bytes.size() - tag_), 0, bytes.back()};
    std::memcpy(&out.time, &bytes[bytes.size() - tag_], 8);
    return out;
  }

  JoinResult finish() {
    result_.sent = static_cast<double>(sent_[kJoiner]) / static_cast<double>(pieces_);
    if (sent_[kLooker] > 0) result_.lost = static_cast<double>(dropped_[kLooker]) / static_cast<double>(sent_[kLooker]);
    if (took_.empty()) return result_;
    std::ranges::sort(took_);
    result_.worst = took_.back() - took_.front();
    result_.waits = took_[took_.size() * 99 / 100] - took_.front();
    return result_;
  }

  SessionServer server_;
  std::array<std::optional<SessionClient>, 2> clients_;
  std::optional<Link> up_, down_;
  std::array<RigidSample, kBodies> bodies_{};
  std::uint64_t now_ = kStart, tick_at_ = kStart, pieces_ = 0;
  std::int64_t tick_ = 0;
  std::size_t tag_ = 9;  // [bytes]
  bool measures_ = false;
  std::array<std::uint64_t, 2> sent_{}, dropped_{};  // datagrams to each client; of them by the full queue
  std::vector<double> took_;                         // [s] on the way to the looker
  std::vector<std::uint8_t> bytes_;
  JoinResult result_;
};

}  // namespace

Result<JoinResult> run_join(const JoinCase& of) {
  TACTUS_TRY(Line line, Line::create(of));
  return line.run();
}

}  // namespace tactus::sim::study
