// SPDX-License-Identifier: Apache-2.0
#include "lab/study/session.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <numbers>

#include <tactus/base/rule.h>
#include <tactus/metrics/played_shapes.h>
#include <tactus/trace/trace_scene.h>

namespace tactus::sim::study {
namespace {

constexpr std::int64_t kWarm = 1;    // [s] after which is judged
constexpr std::int64_t kTimed = 16;  // each such tick's coding is timed

Result<SharedScene> scene_of(const Motion& motion, std::uint8_t baselines) {
  TACTUS_TRY(SceneBuilder builder, scene_builder(motion.info, motion.frames.front(), motion.coding, motion.sender));
  TACTUS_TRY(SharedScene scene, builder.baselines(baselines).build());
  return scene;
}

double cpu_now() noexcept {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

std::string percent(double fraction) { return std::to_string(std::lround(100 * fraction)) + " %"; }
std::string milliseconds(Microseconds time) { return std::to_string(time / 1000) + " ms"; }

std::string kilobits(std::uint64_t rate) { return std::to_string(rate / 1000) + " kbit/s"; }

/// in  fraction  0 to 1
double quantile(std::vector<double>& values, double fraction) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::size_t>(fraction * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(at));
  return values[at];
}
double median(std::vector<double>& values) { return quantile(values, 0.5); }

/// When the client has a state that the server has sent after the last outage.
class Recovery {
 public:
  /// in   substream  that is looked at
  Recovery(const LinkOptions& link, std::uint32_t tick_rate, std::size_t substream)
      : tick_rate_(tick_rate), substream_(substream) {
    if (!link.outages.empty()) healed_ = 1e-6 * static_cast<double>(link.outages.back().end);
  }
  void look(SessionNetwork& network, std::int64_t tick) {
    const double time = static_cast<double>(tick) / tick_rate_;
    if (healed_ < 0 || time < healed_ || time_ > 0) return;
    const std::uint64_t sent = network.server().state_hash(0, substream_);
    if (!sent_.empty() && sent_.back() != sent) sent_.push_back(sent);
    if (sent_.empty()) sent_.push_back(sent);  // of before
    const std::uint64_t has = network.client(0).receiver()->state_hash(substream_);
    if (std::find(sent_.begin() + 1, sent_.end(), has) != sent_.end()) time_ = std::max(time - healed_, 1e-6);
  }
  double time() const noexcept { return time_; }  ///< [s] after the outage; 0: there was none

 private:
  double tick_rate_, healed_ = -1, time_ = 0;
  std::size_t substream_;
  std::vector<std::uint64_t> sent_;  // hashes of the server's states
};

/// Runs of ticks over a bound, and what the client shows.
class Judge {
 public:
  Judge(const Motion& motion, SessionResult& result)
      : motion_(motion), result_(result), errors_(motion.info, motion.sender.triggers), shown_(motion.info.objects.size()) {
    const auto grid = GridExponents{}.position;
    for (std::size_t i = 0; i < motion.info.meshes.size(); ++i) {
      const TraceDeformable& mesh = motion.info.meshes[i];
      DeformableErrors errors(mesh.rest, motion.sender.deformable.thresholds, motion.coding.deformable.rings, grid);
      shapes_.emplace_back(i, std::move(errors), static_cast<std::size_t>(kKept / mesh.period) + 1);
    }
  }

  /// pre  every tick of the motion, in order
  void look(SessionNetwork& network, const TraceFrame& frame) {
    SessionClient& client = network.client(0);
    const std::int64_t shown = client.shown_tick(network.now());
    const std::int64_t first = kWarm * motion_.info.tick_rate;
    if (frame.tick >= first) keep(frame);
    if (shown <= last_ || shown < first || shown >= static_cast<std::int64_t>(motion_.frames.size())) return;
    last_ = shown;
    behind_ += frame.tick - shown;
    ++looks_;
    bound_scale_ += network.server().status(0).bound_scale;
    Replica& replica = client.receiver()->replica();
    const std::uint64_t shapes_before = judged_shapes(), before = broken();
    for (PlayedShapes& shapes : shapes_) shapes.look(replica, shown);
    const bool shapes_over = broken() > before;
    judge_poses(client, shown);
    if (shown_.empty() && judged_shapes() == shapes_before) return;
    ++result_.ticks;
    result_.shape += shapes_over ? 1 : 0;
    count(shown, broken() > before);
  }
  void finish() {
    count(last_, false);
    const double tick = 1.0 / motion_.info.tick_rate;
    result_.position = errors_.position().ticks_over();
    result_.rotation = errors_.rotation().ticks_over();
    result_.force = errors_.force().ticks_over();
    result_.longest = tick * static_cast<double>(longest_);
    result_.mean = runs_ == 0 ? 0 : tick * static_cast<double>(run_time_) / static_cast<double>(runs_);
    result_.mean_bound_scale = looks_ == 0 ? 1 : bound_scale_ / static_cast<double>(looks_);
    result_.error_median = quantile(worst_, 0.5);
    result_.error_p95 = quantile(worst_, 0.95);
    result_.worst = quantile(worst_, 1);
    result_.behind = looks_ == 0 ? 0 : tick * static_cast<double>(behind_) / static_cast<double>(looks_);
  }

 private:
  static constexpr std::int64_t kKept = 4096;  // [ticks] of true shapes: no client lags behind by more

  void keep(const TraceFrame& frame) {
    for (std::size_t i = 0; i < shapes_.size(); ++i)
      if (frame.meshes[i].updated) shapes_[i].add(frame.tick, frame.meshes[i].displacements, touch_of(frame, i));
  }
  void judge_poses(SessionClient& client, std::int64_t shown) {
    if (shown_.empty()) return;
    for (std::uint32_t i = 0; i < shown_.size(); ++i) shown_[i] = client.pose(i, shown);
    const TraceFrame& truth = motion_.frames[static_cast<std::size_t>(shown)];
    errors_.add(truth, shown_);
    worst_.push_back(largest_error(truth));
  }
  /// [bounds] of position and rotation
  double largest_error(const TraceFrame& truth) const {
    const RigidTriggers& bounds = errors_.bounds();
    double out = 0;
    for (std::size_t i = 0; i < shown_.size(); ++i) {
      const Pose& is = truth.objects[i].pose;
      const Quat turn = shown_[i].rotation * conjugate(is.rotation);
      const double angle = 2 * std::atan2(norm(Vec3{turn.x, turn.y, turn.z}), std::abs(turn.w));
      out = std::max({out, norm(shown_[i].position - is.position) / bounds.visual_position, angle / bounds.visual_rotation});
    }
    return out;
  }
  /// A run goes from its first tick over a bound to the next one that is not.
  void count(std::int64_t tick, bool over) {
    if (over) ++result_.over;
    if (over == (run_begin_ >= 0)) return;
    if (over) {
      run_begin_ = tick;
      ++runs_;
      return;
    }
    longest_ = std::max(longest_, tick - run_begin_);
    run_time_ += tick - run_begin_;
    run_begin_ = -1;
  }
  std::uint64_t judged_shapes() const {
    std::uint64_t out = 0;
    for (const PlayedShapes& shapes : shapes_) out += shapes.errors().frames();
    return out;
  }
  /// Grows with each tick at which something is over its bound.
  std::uint64_t broken() const {
    const bool haptic = motion_.sender.triggers.haptic != HapticRule::off;
    std::uint64_t out = errors_.position().ticks_over() + errors_.rotation().ticks_over();
    if (haptic) out += errors_.force().ticks_over();
    for (const PlayedShapes& shapes : shapes_) out += shapes.errors().all().violations;
    return out;
  }

  const Motion& motion_;
  SessionResult& result_;
  ErrorMetrics errors_;
  std::vector<PlayedShapes> shapes_;
  std::vector<Pose> shown_;
  std::vector<double> worst_;  // [bounds] of each tick
  double bound_scale_ = 0;     // sum
  std::int64_t last_ = -1, behind_ = 0, looks_ = 0;
  std::int64_t run_begin_ = -1, longest_ = 0, run_time_ = 0, runs_ = 0;  // [ticks]; -1: in no run
};

}  // namespace

Motion swinging_bodies(std::int64_t ticks) {
  Motion out{.name = "three swinging bodies",
             .info = {.tick_rate = 1000, .objects = {}, .users = {}, .source = {}, .scene = {}},
             .frames = {}};
  out.sender.triggers.visual_position = 1e-3;
  out.sender.triggers.visual_rotation = std::numbers::pi / 180;
  for (const char* name : {"a", "b", "c"}) out.info.objects.push_back({name});
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    TraceFrame& frame = out.frames.emplace_back();
    frame.tick = tick;
    const double t = 1e-3 * static_cast<double>(tick), a = 0.15;
    for (int k = 0; k < 3; ++k) {
      const double w[] = {2 * std::numbers::pi * (0.5 + 0.13 * k), 2 * std::numbers::pi * (0.7 + 0.11 * k),
                          2 * std::numbers::pi * (0.9 - 0.07 * k)};
      const double phase[] = {1.0 * k, 1.0 + k, 2.0 * k};
      RigidSample body;
      body.pose.position = {a * std::sin(w[0] * t + phase[0]), a * std::sin(w[1] * t + phase[1]),
                            a * std::sin(w[2] * t + phase[2])};
      body.velocity = {a * w[0] * std::cos(w[0] * t + phase[0]), a * w[1] * std::cos(w[1] * t + phase[1]),
                       a * w[2] * std::cos(w[2] * t + phase[2])};
      const double half = 0.3 * std::sin(w[0] * t + k), turning = 0.6 * w[0] * std::cos(w[0] * t + k);
      body.pose.rotation = {std::cos(half), 0.6 * std::sin(half), 0, 0.8 * std::sin(half)};
      body.angular_velocity = {0.6 * turning, 0, 0.8 * turning};
      frame.objects.push_back(body);
    }
  }
  return out;
}

Result<double> chain_payload(const Motion& motion) {
  TACTUS_TRY(const SharedScene scene, scene_of(motion, 1));
  SenderOptions options = motion.sender;
  options.policy.key_interval = 0;
  TACTUS_TRY(Sender sender, Sender::create(scene, options));
  FrameTruth truth(motion.info);
  std::uint64_t bytes = 0;
  for (const TraceFrame& frame : motion.frames) {
    TACTUS_TRY(const auto packets, sender.encode(frame.tick, truth.of(frame)));
    for (const Packet& packet : packets) bytes += packet.bytes.size();
  }
  return 8.0 * static_cast<double>(bytes) * motion.info.tick_rate / static_cast<double>(motion.frames.size());
}

Result<SessionResult> run_session(const Motion& motion, const SessionCase& one) {
  TACTUS_TRY(const SharedScene scene, scene_of(motion, 64));
  TACTUS_TRY(const double chain, one.limit_of_chain + one.line_of_chain > 0 ? chain_payload(motion) : Result<double>(0.0));
  NetworkOptions options{.uplink = one.link,
                         .downlink = one.link,
                         .device = {},
                         .playout = one.playout,
                         .role = Role::observer,
                         .rate = one.limit_of_chain > 0 ? static_cast<std::uint64_t>(one.limit_of_chain * chain) : one.rate,
                         .loss = one.policy};
  if (one.line_of_chain > 0) options.downlink.rate = one.line_of_chain * chain;
  TACTUS_TRY(const auto network, SessionNetwork::create(scene, 1, motion.sender, options));
  SessionResult result{.of = one};
  Judge judge(motion, result);
  FrameTruth truth(motion.info);
  std::vector<double> coding;
  Recovery recovery(one.link, motion.info.tick_rate, scene->moving().empty() ? 1 : 0);
  for (const TraceFrame& frame : motion.frames) {
    TACTUS_CHECK(network->to_server(frame.tick, {}, {}));
    const bool timed = frame.tick % kTimed == 0;
    const double before = timed ? cpu_now() : 0;
    TACTUS_CHECK(network->to_clients(frame.tick, truth.of(frame)));
    if (timed) coding.push_back(cpu_now() - before);
    judge.look(*network, frame);
    recovery.look(*network, frame.tick);
  }
  judge.finish();
  result.recovery = recovery.time();
  result.seconds = static_cast<double>(motion.frames.size()) / motion.info.tick_rate;
  result.down = network->sent_to(0);
  result.up = network->sent_by(0);
  result.bound_scaling = network->server().status(0).bound_scaling;
  result.server_time = median(coding);
  return result;
}

std::vector<SessionCase> session_cases(bool brief, std::uint64_t seed) {
  std::vector<SessionCase> out;
  const LinkOptions plain{.seed = seed, .delay = 20'000, .duplicates = 0.05};
  const auto add = [&](const char* group, std::string name, const LinkOptions& link, PlayoutOptions playout = {}) {
    out.push_back({group, std::move(name), link, playout});
  };
  const auto with = [&](auto&& change) {
    LinkOptions link = plain;
    change(link);
    return link;
  };
  for (const double loss : {0.0, 0.01, 0.1, 0.3, 0.5})
    if (!brief || loss == 0.1) add("loss", percent(loss), with([&](LinkOptions& l) { l.loss = loss; }));
  for (const double loss : {0.0, 0.01, 0.1, 0.3})
    if (!brief || loss == 0.1)
      add("loss, jitter up to 30 ms", percent(loss), with([&](LinkOptions& l) { l.loss = loss, l.jitter = 30'000; }));
  if (brief) return out;
  for (const double loss : {0.01, 0.1, 0.3})
    add("loss in bursts of 5", percent(loss), with([&](LinkOptions& l) { l.loss = loss, l.burst = 5; }));
  for (const Microseconds trip : {2'000, 20'000, 100'000, 200'000})
    add("10 % loss, round trip", milliseconds(trip), with([&](LinkOptions& l) { l.loss = 0.1, l.delay = trip / 2; }));
  for (const std::uint32_t playout : {0u, 10'000u, 20'000u, 40'000u, 60'000u, 100'000u})
    add("10 % loss, playout delay", milliseconds(playout), with([&](LinkOptions& l) { l.loss = 0.1; }), {playout});
  add("disorder", "5 % come 30 ms later", with([&](LinkOptions& l) { l.held_back = 0.05, l.held_back_by = 30'000; }));
  add("disorder", "gamma, 20 ms +- 10 ms for 1 s",
      with([&](LinkOptions& l) { l.gamma_mean = 20'000, l.gamma_deviation = 10'000; }));
  for (const Microseconds length : {100'000, 1'000'000, 10'000'000, 60'000'000})
    add("outage", milliseconds(length), with([&](LinkOptions& l) { l.outages = {{5'000'000, 5'000'000 + length}}; }));
  for (const std::uint64_t rate : {64'000u, 48'000u, 32'000u}) {
    out.push_back({"rate at most, all layers", kilobits(rate), plain, {}, rate});
    add("bottleneck, 64 KiB of queue", kilobits(rate), with([&](LinkOptions& l) { l.rate = static_cast<double>(rate); }));
  }
  std::ranges::stable_sort(out.end() - 6, out.end(), std::ranges::greater{}, &SessionCase::group);
  constexpr std::array kOfChain{3.0, 2.0, 1.5, 1.1};
  for (const double fraction : kOfChain) {
    out.push_back({.group = "rate at most, of the chain", .name = percent(fraction), .link = plain, .limit_of_chain = fraction});
  }
  for (const double fraction : kOfChain)
    out.push_back({.group = "bottleneck, of the chain", .name = percent(fraction), .link = plain, .line_of_chain = fraction});
  return out;
}

}  // namespace tactus::sim::study
