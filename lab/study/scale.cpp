// SPDX-License-Identifier: Apache-2.0
#include "lab/study/scale.h"

#include <malloc.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include <tactus/scene/scene_builder.h>
#include <tactus/session/session_client.h>
#include <tactus/session/session_server.h>
#include <tactus/sim/random.h>

namespace tactus::sim::study {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint64_t kTick = 1000;   // [us]
constexpr std::int64_t kWarmUp = 2000;  // ticks
constexpr DecodeLimits kLimits{.objects = 1u << 20, .state_bytes = ~std::uint64_t{0} >> 1};
constexpr double kStep = 1e-3, kPi = 3.141592653589793;

/// [s] of the processor that this thread has had.
double cpu_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// [bytes] in memory now.
double resident() {
  malloc_trim(0);  // what was freed is not used
  std::FILE* const file = std::fopen("/proc/self/statm", "r");
  if (file == nullptr) return 0;
  long size = 0, pages = 0;
  const bool read = std::fscanf(file, "%ld %ld", &size, &pages) == 2;
  std::fclose(file);
  return read ? static_cast<double>(pages) * static_cast<double>(sysconf(_SC_PAGESIZE)) : 0;
}

double median(std::vector<double>& values) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  return values[values.size() / 2];
}

/// Each of the moving objects swings and turns; once a second or so it is knocked into another direction.
class Motions {
 public:
  /// in  spacing  [m] between neighbours;  stride  from one that moves to the next
  Motions(std::uint32_t objects, std::uint32_t moving, double spacing, std::uint32_t stride, std::uint64_t seed)
      : random_(seed), spacing_(spacing), samples_(objects), swings_(moving) {
    for (std::uint32_t i = 0; i < objects; ++i) samples_[i].pose.position = home(i, spacing);
    for (Swing& swing : swings_) knock(swing);
    for (std::uint32_t i = 0; i < moving; ++i) moved_.push_back(i * stride);
  }
  static Vec3 home(std::uint32_t i, double spacing) {
    return spacing * Vec3{1.0 * (i % 100), 1.0 * (i / 100 % 100), 1.0 * (i / 10'000)};
  }
  std::span<const std::uint32_t> moved() const { return moved_; }
  std::span<const RigidSample> step() {
    time_ += kStep;
    for (std::uint32_t i = 0; i < swings_.size(); ++i) {
      Swing& swing = swings_[i];
      if (random_.uniform(0, 1) < kStep) knock(swing);
      const double phase = swing.rate * (time_ - swing.since), angle = swing.spin * (time_ - swing.since);
      RigidSample& sample = samples_[moved_[i]];
      sample.pose.position = home(moved_[i], spacing_) + std::sin(phase) * swing.reach;
      sample.velocity = swing.rate * std::cos(phase) * swing.reach;
      sample.pose.rotation = {std::cos(0.5 * angle), 0, 0, std::sin(0.5 * angle)};
      sample.angular_velocity = {0, 0, swing.spin};
    }
    return samples_;
  }

 private:
  struct Swing {
    Vec3 reach;  // [m]
    double rate = 0, spin = 0, since = 0;
  };
  void knock(Swing& swing) {
    swing.reach = {random_.uniform(-0.1, 0.1), random_.uniform(-0.1, 0.1), random_.uniform(-0.1, 0.1)};
    swing.rate = 2 * kPi * random_.uniform(0.3, 1.5);
    swing.spin = random_.uniform(-6, 6);
    swing.since = time_;
  }
  Random random_;
  double time_ = 0, spacing_;
  std::vector<RigidSample> samples_;
  std::vector<Swing> swings_;
  std::vector<std::uint32_t> moved_;
};

class DelayLine {
 public:
  DelayLine(const ScaleCase& of, std::uint64_t seed) : random_(seed), loss_(of.loss), delay_(of.delay) {}
  void send(std::uint64_t now, std::span<const std::uint8_t> bytes) {
    if (loss_ > 0 && random_.uniform(0, 1) < loss_) return;
    on_it_.emplace_back(now + delay_, Bytes(bytes.begin(), bytes.end()));
  }
  std::optional<Bytes> poll(std::uint64_t now) {
    if (on_it_.empty() || on_it_.front().first > now) return std::nullopt;
    Bytes out = std::move(on_it_.front().second);
    on_it_.pop_front();
    return out;
  }

 private:
  Random random_;
  double loss_;
  std::uint64_t delay_;
  std::deque<std::pair<std::uint64_t, Bytes>> on_it_;
};

struct Heard {
  std::uint64_t peer = 0;
  Bytes bytes;
};
using Outbox = std::vector<Heard>;

/// All that the server does in a tick.
bool serve(SessionServer& server, std::uint64_t now, std::int64_t tick, const Truth& truth, const std::vector<Heard>& in,
           Outbox& out, double& submit) {
  for (const Heard& heard : in) static_cast<void>(server.handle_datagram(now, heard.peer, heard.bytes));
  server.handle_timeout(now);
  const double before = cpu_time();
  const bool fine = server.submit(now, tick, truth).has_value();
  submit = cpu_time() - before;
  while (const auto datagram = server.poll_datagram(now))
    out.push_back({datagram->peer, Bytes(datagram->bytes.begin(), datagram->bytes.end())});
  while (server.poll_event()) {
  }
  return fine;
}

}  // namespace

/// The same in the ticks that are measured. The name is what callgrind is told to count.
extern "C" [[gnu::noinline]] bool tactus_scale_tick(SessionServer& server, std::uint64_t now, std::int64_t tick,
                                                    const Truth& truth, const std::vector<Heard>& in, Outbox& out,
                                                    double& submit) {
  return serve(server, now, tick, truth, in, out, submit);
}

namespace {

class World {
 public:
  static Result<World> create(const ScaleCase& of) {
    SceneBuilder builder(1000);
    for (std::uint32_t i = 0; i < of.objects; ++i) {
      builder.rigid("body " + std::to_string(i), {Motions::home(i, spacing(of)), {}});
    }
    if (of.reach > 0) builder.interest(1, of.reach);
    TACTUS_TRY(auto scene, builder.baselines(64).build(kLimits));
    SessionServerOptions options;
    options.clients = of.clients;
    options.works_elsewhere = true;
    options.sender.triggers.haptic = HapticRule::off;
    options.sender.triggers.visual_position = 6e-3;
    TACTUS_TRY(auto server, SessionServer::create(std::move(scene), options, of.seed, kStart));
    return World(of, std::move(server));
  }

  Result<ScaleResult> run() {
    const double empty = resident();
    TACTUS_CHECK(join());
    for (std::int64_t i = 0; i < kWarmUp; ++i) TACTUS_CHECK(step(serve));
    times_.clear();
    submits_ = 0, datagrams_ = bytes_ = 0;
    for (std::int64_t i = 0; i < of_.ticks; ++i) TACTUS_CHECK(step(tactus_scale_tick));
    const double clients = of_.clients, ticks = static_cast<double>(of_.ticks);
    ScaleResult out;
    for (const double time : times_) out.mean += time / ticks;
    out.worst = *std::ranges::max_element(times_);
    out.median = median(times_);
    out.submit = submits_ / ticks;
    out.worst_join = *std::ranges::max_element(joins_);
    out.join = median(joins_);
    out.worst_work = *std::ranges::max_element(works_);
    out.work = median(works_);
    out.memory = (resident() - empty) / clients;
    out.datagrams = static_cast<double>(datagrams_) / (clients * ticks);
    out.bytes = static_cast<double>(bytes_) / (clients * ticks);
    for (std::uint16_t i = 0; i < of_.clients; ++i) out.live += server_.status(i).state == SessionState::live ? 1u : 0u;
    users_.clear();
    const double without = resident();
    out.server_memory = (without - empty) / clients;
    return out;
  }

 private:
  static constexpr std::uint64_t kStart = 1'000'000;
  struct User {
    SessionClient client;
    DelayLine up, down;
  };

  World(const ScaleCase& of, SessionServer server)
      : of_(of),
        server_(std::move(server)),
        motions_(of.objects, of.moving, spacing(of), of.spread && of.moving > 0 ? of.objects / of.moving : 1, of.seed) {}
  /// [m] from object to object.
  static double spacing(const ScaleCase& of) { return of.spread ? 1 : 0.1; }
  /// [m] Where a client is: it walks in a circle, 1.4 m/s.
  Vec3 eyes(std::size_t client) const {
    const double turn = 1.4 / 5 * static_cast<double>(now_) * 1e-6 + static_cast<double>(client);
    const Vec3 centre{7.0 * static_cast<double>(client % 13), 11.0 * static_cast<double>(client / 13 % 9), 1.6};
    return centre + 5 * Vec3{std::cos(turn), std::sin(turn), 0};
  }

  /// One after another, before the first tick; each call of the server is timed.
  Result<void> join() {
    for (std::uint64_t number = 0; number < of_.clients; ++number) {
      TACTUS_TRY(auto client, SessionClient::create({.role = of_.role, .limits = kLimits}));
      users_.push_back(
          {std::move(client), DelayLine(of_, 1000 + 2 * number + of_.seed), DelayLine(of_, 1001 + 2 * number + of_.seed)});
      User& user = users_.back();
      if (of_.reach > 0) user.client.set_viewpoint(eyes(number));
      user.client.open(now_, number + 1);
      for (int k = 0; k < 60'000 && server_.status(static_cast<std::uint16_t>(number)).state != SessionState::live; ++k) {
        while (const auto datagram = user.client.poll_datagram(now_)) hear(number + 1, *datagram);
        while (const auto datagram = server_.poll_datagram(now_))
          if (datagram->peer == number + 1) static_cast<void>(user.client.handle_datagram(now_, datagram->bytes));
        now_ += 500;
        user.client.handle_timeout(now_);
      }
    }
    return {};
  }
  void hear(std::uint64_t peer, std::span<const std::uint8_t> bytes) {
    const auto client = static_cast<std::uint16_t>(peer - 1);
    const auto state = server_.status(client).state;
    const double before = cpu_time();
    static_cast<void>(server_.handle_datagram(now_, peer, bytes));
    const double time = cpu_time() - before;
    if (server_.status(client).state != state) joins_.push_back(time);
    work();
  }
  /// What a program does on another thread; the calls before and after it are of the thread of the ticks.
  void work() {
    double before = cpu_time();
    auto asked = server_.poll_work();
    if (!asked) return;
    const double asking = cpu_time() - before;
    before = cpu_time();
    asked->run();
    works_.push_back(cpu_time() - before);
    before = cpu_time();
    static_cast<void>(server_.take(now_, *std::move(asked)));
    joins_.push_back(asking + cpu_time() - before);
  }

  Result<void> step(decltype(serve)& tick_of) {
    in_.clear();
    out_.clear();
    for (std::size_t i = 0; i < users_.size(); ++i)
      while (auto bytes = users_[i].up.poll(now_)) in_.push_back({i + 1, std::move(*bytes)});
    const std::span<const RigidSample> objects = motions_.step();
    Truth truth{.objects = objects};
    if (of_.names_moved) truth.moved = motions_.moved();
    double submit = 0;
    const double before = cpu_time();
    const bool fine = tick_of(server_, now_, tick_++, truth, in_, out_, submit);
    times_.push_back(cpu_time() - before);
    submits_ += submit;
    if (!fine) return tl::unexpected(Error{Errc::internal, "R-API-5"});
    for (const Heard& sent : out_) {
      users_[sent.peer - 1].down.send(now_, sent.bytes);
      ++datagrams_, bytes_ += sent.bytes.size();
    }
    for (User& user : users_) {
      if (of_.reach > 0) user.client.set_viewpoint(eyes(static_cast<std::size_t>(&user - users_.data())));
      while (const auto bytes = user.down.poll(now_)) static_cast<void>(user.client.handle_datagram(now_, *bytes));
      user.client.handle_timeout(now_);
      while (const auto datagram = user.client.poll_datagram(now_)) user.up.send(now_, *datagram);
    }
    now_ += kTick;
    return {};
  }

  ScaleCase of_;
  SessionServer server_;
  Motions motions_;
  std::vector<User> users_;
  std::vector<Heard> in_;
  Outbox out_;
  std::vector<double> times_, joins_, works_;
  double submits_ = 0;
  std::uint64_t now_ = kStart, datagrams_ = 0, bytes_ = 0;
  std::int64_t tick_ = 0;
};

}  // namespace

Result<ScaleResult> run_scale(const ScaleCase& of) {
  TACTUS_TRY(World world, World::create(of));
  return world.run();
}

}  // namespace tactus::sim::study
