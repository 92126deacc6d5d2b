// SPDX-License-Identifier: Apache-2.0
/// An end stands still: its program is stopped, or its machine sleeps and the clock with it. Nobody may feel a picture of before.
#include <tactus/session/session_client.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <tactus/scene/scene_builder.h>
#include <tactus/session/session_server.h>
#include <tactus/sim/link/link.h>

namespace tactus {
namespace {

enum class Who { server, client };
enum class Clock { runs, stops };
struct Case {
  Who who = Who::server;
  Clock clock = Clock::runs;
  int milliseconds = 0;
  double loss = 0;
  bool rests = false;  ///< nothing moves: no packets, only acknowledgements

  std::string name() const {
    return std::string(who == Who::server ? "server" : "client") + (clock == Clock::runs ? " stopped " : " asleep ") +
           std::to_string(milliseconds) + " ms, loss " + std::to_string(loss) + (rests ? ", at rest" : "");
  }
};

/// A pendulum over 20 ms each way; the client's device is always in contact. True time is that of the links.
class Standstill {
 public:
  explicit Standstill(const Case& of) : of_(of) {
    SessionServerOptions options;
    options.sender.triggers.visual_position = 0.001;
    const SharedScene scene = SceneBuilder(1000).rigid("pendulum").baselines(64).build().value();
    server_.emplace(SessionServer::create(scene, options, 77, time_).value());
    client_.emplace(SessionClient::create({.role = Role::participant}).value());
    client_->open(client_now(), 5);
  }

  void run(int milliseconds) {
    for (int i = 0; i < milliseconds; ++i) step(true, true);
  }
  void stand() {
    const bool server = of_.who == Who::server;
    for (int i = 0; i < of_.milliseconds; ++i) {
      if (of_.clock == Clock::stops) (server ? server_slept_ : client_slept_) += 1000;
      step(!server, server);
    }
    most_ = 0;
  }

  /// The world takes so many ticks per millisecond from now on, below 1.
  void slow_down(double rate) {
    rate_ = rate;
    due_ = static_cast<double>(tick_);
  }

  bool is_live() const { return client_->status().state == SessionState::live; }
  double fraction() const { return fraction_; }
  std::int64_t lag() const { return lag_; }  ///< [ticks] of what is shown behind the server
  // Since forget(), [ms] while more than half of the force was rendered:
  int stale() const { return stale_; }                     ///< in which the picture was older than 150 ms
  std::int64_t worst_lead() const { return worst_lead_; }  ///< ahead of the server
  double most() const { return most_; }                    ///< largest fraction since it went on
  int frozen() const { return frozen_; }                   ///< in which the picture stood
  void forget() {
    worst_lead_ = 0;
    frozen_ = stale_ = 0;
    most_ = worst_offset_ = 0;
  }
  std::uint64_t wrong_states() const { return server_->status(0).traffic.wrong_states; }
  double worst_offset() const { return worst_offset_; }  ///< [ms] since forget()
  double offset_error() const {                          ///< [ms]
    const auto offset = client_->status().clock_offset;
    const auto truth = static_cast<std::int64_t>(server_now()) - static_cast<std::int64_t>(client_now());
    return offset ? 1e-3 * static_cast<double>(*offset - truth) : NAN;
  }

 private:
  static sim::LinkOptions link(std::uint64_t seed, double loss) { return {.seed = seed, .delay = 20'000, .loss = loss}; }
  RigidSample pendulum(std::int64_t tick) const {
    if (of_.rests && tick > 3000) tick = 3000;
    const double w = 2 * std::numbers::pi, t = 1e-3 * static_cast<double>(tick);
    const double v = of_.rests && tick == 3000 ? 0 : 0.1 * w * std::cos(w * t);
    return {.pose = {{0.1 * std::sin(w * t), 0, 0}, {}}, .velocity = {v, 0, 0}, .angular_velocity = {}};
  }
  std::uint64_t server_now() const { return time_ - server_slept_; }
  std::uint64_t client_now() const { return time_ + 3'000'000 - client_slept_; }

  void step(bool server_works, bool client_works) {
    if (server_works) tick();
    for (int i = 0; i < 4; ++i, time_ += 250) {
      if (server_works) serve();
      if (client_works) play();
    }
    if (client_works) look();
  }
  void tick() {
    due_ += rate_;
    if (rate_ < 1 && due_ < static_cast<double>(tick_ + 1)) return;
    tick_ = rate_ < 1 ? tick_ + 1 : static_cast<std::int64_t>((server_now() - kStart) / 1000);
    const RigidSample sample = pendulum(tick_);
    ASSERT_TRUE(server_->submit(server_now(), tick_, {.objects = {&sample, 1}, .contacts = {}, .deformables = {}}));
  }
  void serve() {
    while (const auto datagram = up_.poll(static_cast<sim::Microseconds>(time_)))
      (void)server_->handle_datagram(server_now(), 1, datagram->bytes);
    server_->handle_timeout(server_now());
    while (const auto datagram = server_->poll_datagram(server_now()))
      down_.send(static_cast<sim::Microseconds>(time_), datagram->bytes);
    while (server_->poll_event()) {
    }
  }
  void play() {
    while (const auto datagram = down_.poll(static_cast<sim::Microseconds>(time_)))
      (void)client_->handle_datagram(client_now(), datagram->bytes);
    client_->handle_timeout(client_now());
    while (const auto datagram = client_->poll_datagram(client_now())) up_.send(static_cast<sim::Microseconds>(time_), *datagram);
    while (client_->poll_event()) {
    }
  }
  void look() {
    const Vec3 position{0.01 * std::sin(3e-6 * static_cast<double>(time_)), 0, 0};
    ASSERT_TRUE(client_->submit(client_now(), {.position = position}, DeviceContact{position, 500}));
    const std::int64_t shown = client_->shown_tick(client_now());
    fraction_ = client_->force_fraction(client_now());
    most_ = std::max(most_, fraction_);
    worst_offset_ = std::max(worst_offset_, std::abs(offset_error()));
    lag_ = tick_ - shown;
    if (shown >= 0 && fraction_ > 0.5) {
      if (lag_ > 150) ++stale_;
      worst_lead_ = std::max(worst_lead_, -lag_);
      if (shown == shown_) ++frozen_;
    }
    shown_ = shown;
  }

  static constexpr std::uint64_t kStart = 20'000'000;  // [us]

  Case of_;
  std::uint64_t time_ = kStart, server_slept_ = 0, client_slept_ = 0;  // [us]
  std::optional<SessionServer> server_;
  std::optional<SessionClient> client_;
  sim::Link up_ = sim::Link::create(link(5, of_.loss)).value(), down_ = sim::Link::create(link(6, of_.loss)).value();
  std::int64_t tick_ = -1, lag_ = 0, worst_lead_ = 0, shown_ = -1;
  double rate_ = 1, due_ = 0;  // of the world; [ticks]
  double fraction_ = 0, most_ = 0, worst_offset_ = 0;
  int frozen_ = 0, stale_ = 0;
};

std::vector<Case> cases() {
  std::vector<Case> out;
  for (const Who who : {Who::server, Who::client})
    for (const Clock clock : {Clock::runs, Clock::stops})
      for (const int milliseconds : {50, 200, 1000, 5000, 60'000})
        for (const double loss : {0.0, 0.1})
          for (const bool rests : {false, true}) {
            out.push_back({who, clock, milliseconds, loss, rests});
          }
  return out;
}

TEST(SessionStandstill, NobodyFeelsAPictureOfBefore) {
  for (const Case& of : cases()) {
    Standstill ends(of);
    ends.run(12'000);
    ASSERT_TRUE(ends.is_live()) << of.name();
    ASSERT_EQ(ends.fraction(), 1) << of.name();
    const std::int64_t usual = ends.lag();
    ends.forget();
    ends.stand();
    ends.run(1500);
    EXPECT_LE(ends.stale(), 100) << of.name();
    EXPECT_LE(ends.worst_lead(), 100) << of.name();
    EXPECT_LE(ends.frozen(), 100) << of.name();
    EXPECT_EQ(ends.most(), 1) << of.name() << ": all of the force again";
    if (of.clock == Clock::runs) {
      EXPECT_LE(ends.worst_offset(), 40) << of.name() << ": what waited in the meantime says nothing";
    }
    EXPECT_NEAR(static_cast<double>(ends.lag()), static_cast<double>(usual), 60) << of.name();
    ends.run(15'000);
    EXPECT_GE(ends.lag(), 20) << of.name() << ", later: the link takes as long";
    EXPECT_LE(ends.lag(), of.loss > 0 ? 85 : 65) << of.name() << ", later";
    EXPECT_NEAR(ends.offset_error(), 0, 5) << of.name();
    EXPECT_EQ(ends.wrong_states(), 0u) << of.name();
  }
}

/// Whenever it falls asleep: leads of before and after may come to be looked at together.
TEST(SessionStandstill, EveryMomentIsAsGood) {
  for (int phase = 0; phase < 100; phase += 10) {
    for (const int asleep : {200, 1000, 5000}) {
      Standstill ends({.who = Who::server, .clock = Clock::stops, .milliseconds = asleep});
      ends.run(12'000 + phase);
      const std::int64_t usual = ends.lag();
      ends.stand();
      ends.run(1'500);
      EXPECT_LE(ends.lag(), usual + 60) << phase << ", " << asleep;
      EXPECT_EQ(ends.fraction(), 1) << phase << ", " << asleep;
    }
  }
}

/// A world that cannot keep up gives its ticks numbers one after the other, though each stands for a millisecond: what is shown stays near it.
TEST(SessionStandstill, AWorldThatIsSlowIsShownAsItGoesOn) {
  for (const double rate : {0.99, 0.9, 0.5}) {
    Standstill ends({.loss = 0.02});
    ends.run(12'000);
    const std::int64_t usual = ends.lag();
    ends.slow_down(rate);
    ends.forget();
    ends.run(40'000);
    EXPECT_EQ(ends.stale(), 0) << rate;
    EXPECT_LE(ends.lag(), usual + 80) << rate;
    EXPECT_LE(ends.worst_lead(), 100) << rate;
    EXPECT_EQ(ends.fraction(), 1) << rate;
    EXPECT_EQ(ends.wrong_states(), 0u) << rate;
  }
}

}  // namespace
}  // namespace tactus
