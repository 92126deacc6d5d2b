// SPDX-License-Identifier: Apache-2.0
#include "lab/study/signals.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <numbers>
#include <optional>

#include <tactus/session/device_signal.h>
#include <tactus/thesis/force_signal.h>

namespace tactus::sim::study {
namespace {

constexpr double kLengths[]{1e-4, 3e-4, 1e-3, 3e-3};         // [m] bounds of the position
constexpr double kFreeLength = 5e-4;                         // [m] beside a bound of the force
constexpr double kFractions[]{0.02, 0.04, 0.08, 0.12, 0.2};  // p
constexpr std::uint64_t kTimed = 4;                          // each such sample is timed
constexpr double kHalfDiagonal = std::numbers::sqrt3 / 2;    // of a cell of the grid: what rounding may cost

/// Counts and errors of one coding.
struct Tally {
  SignalResult result;
  double square = 0;
  std::vector<double> times{};  // [s]

  template <class Work>
  auto timed(Work&& work) {
    if (result.samples % kTimed != 0) return work();
    const auto before = std::chrono::steady_clock::now();
    auto out = work();
    times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count());
    return out;
  }
  void judge(double error, double fraction) {
    ++result.samples;
    result.largest = std::max(result.largest, error);
    square += error * error;
    result.worst = std::max(result.worst, fraction);
    if (fraction > 1) ++result.over;
  }
  SignalResult summary() const {
    SignalResult out = result;
    out.rms = out.samples == 0 ? 0 : std::sqrt(square / static_cast<double>(out.samples));
    std::vector<double> sorted = times;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::ranges::nth_element(sorted, middle);
    out.time = sorted.empty() ? 0 : *middle;
    return out;
  }
};

/// Both ends of the channel of a device.
class DeviceCoder {
 public:
  static Result<DeviceCoder> create(const TraceInfo& info, std::size_t user, Signal signal, std::string name,
                                    const DeviceCoding& coding) {
    SceneSpec spec;
    spec.tick_rate = info.tick_rate;
    TACTUS_TRY(SharedScene scene, device_scene(spec));
    TACTUS_TRY(Sender sender, Sender::create(scene, device_sender_options(coding)));
    TACTUS_TRY(Receiver receiver, Receiver::create(scene));
    DeviceCoder out{.coding = coding,
                    .sender = std::move(sender),
                    .receiver = std::move(receiver),
                    .truth = {info.tick_rate, info.users[user].senses.velocity},
                    .ack_timeout = static_cast<std::int64_t>(SignalStudy::kRoundTrip * info.tick_rate)};
    out.tally.result = {.user = user, .signal = signal, .name = std::move(name)};
    return out;
  }

  Result<void> add(std::int64_t tick, const DeviceSample& sample, const std::optional<DeviceContact>& touched) {
    const std::optional<DeviceContact> contact = tally.result.signal == Signal::contact ? touched : std::nullopt;
    for (; !acknowledgements.empty() && acknowledgements.front().tick <= tick; acknowledgements.pop_front())
      sender.acknowledge(0, acknowledgements.front().number);
    TACTUS_TRY(const auto packets, tally.timed([&] { return sender.encode(tick, truth.of(tick, sample, contact)); }));
    if (!sender.held().empty()) return tl::unexpected(Error{Errc::invalid_argument, sender.held().front().rule});
    for (const Packet& packet : packets) {
      TACTUS_CHECK(receiver.push(packet.number, packet.bytes, tick));
      acknowledgements.push_back({tick + ack_timeout, packet.number});
      ++tally.result.packets;
      tally.result.bytes += packet.bytes.size();
    }
    const double error = norm(device_at(receiver, tick, 0).position - sample.position);
    tally.judge(error, fraction(error, sample, contact));
    return {};
  }

  /// Of what is permitted: in contact, the force must be right, too.
  double fraction(double error, const DeviceSample& sample, const std::optional<DeviceContact>& contact) const {
    const double grid = kHalfDiagonal * std::ldexp(1.0, -receiver.scene()->grid.position);
    const double length = error / (coding.every_tick ? grid : std::max(coding.position, grid));
    if (!contact) return length;
    const double force = contact->stiffness * norm(contact->proxy - sample.position);
    return std::max(length, contact->stiffness * error / (coding.weber_fraction * std::max(force, RigidTriggers{}.force_floor)));
  }

  struct Acknowledgement {
    std::int64_t tick = 0;
    std::uint64_t number = 0;
  };
  DeviceCoding coding;
  Sender sender;
  Receiver receiver;
  DeviceTruth truth;
  std::int64_t ack_timeout = 0;  // [ticks]
  std::deque<Acknowledgement> acknowledgements{};
  Tally tally{};
};

/// Both ends of the channel of a force.
class ForceCoder {
 public:
  static Result<ForceCoder> create(const TraceInfo& info, std::size_t user, std::string name, const ForceCoding& coding) {
    TACTUS_TRY(const ForceSender sender, ForceSender::create(coding, info.tick_rate));
    ForceCoder out{.coding = coding, .sender = sender, .receiver = ForceReceiver(info.tick_rate)};
    out.tally.result = {.user = user, .signal = Signal::force, .name = std::move(name)};
    return out;
  }

  Result<void> add(std::int64_t tick, const Vec3& force) {
    TACTUS_TRY(const auto sample, tally.timed([&] { return sender.encode(tick, force); }));
    if (!sample.empty()) {
      TACTUS_CHECK(receiver.push(sample));
      ++tally.result.packets;
      tally.result.bytes += sample.size();
    }
    const Vec3 shown = receiver.force(tick);
    const double error = norm(shown - force), grid = kHalfDiagonal * std::ldexp(1.0, -static_cast<int>(kForceExp));
    const double permitted = coding.rule == ForceRule::ieee1918 ? 0.1 * (norm(shown) + 1e-5)
                                                                : coding.weber_fraction * std::max(norm(shown), coding.floor);
    tally.judge(error, error / std::max(permitted, grid));
    return {};
  }

  ForceCoding coding;
  ForceSender sender;
  ForceReceiver receiver;
  Tally tally{};
};

std::string percent(double p) { return std::to_string(std::lround(100 * p)) + " %"; }
std::string millimetres(double length) {
  const long tenths = std::lround(1e4 * length);
  return (tenths % 10 == 0 ? std::to_string(tenths / 10) : "0." + std::to_string(tenths)) + " mm";
}

/// [m] world.   pre  in contact
std::optional<DeviceContact> contact_of(const UserSample& user, std::span<const RigidSample> objects) {
  if (user.surface_contact) return DeviceContact{user.surface_contact->proxy, user.surface_contact->stiffness};
  if (user.contact.kind == ContactKind::none) return std::nullopt;
  return DeviceContact{to_world(objects[user.contact.object].pose, user.contact.point), user.contact.stiffness};
}

}  // namespace

struct SignalStudy::Impl {
  /// What a recording holds of a user.
  struct User {
    std::optional<Vec3> first;  // position
    bool moves = false, touches = false, feels = false;
  };
  std::vector<User> users;
  std::vector<DeviceCoder> devices;
  std::vector<ForceCoder> forces;

  bool has(const SignalResult& result) const {
    const User& user = users[result.user];
    if (result.signal == Signal::force) return user.feels;
    return user.moves && (result.signal == Signal::device || user.touches);
  }
};

SignalStudy::SignalStudy(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
SignalStudy::SignalStudy(SignalStudy&&) noexcept = default;
SignalStudy& SignalStudy::operator=(SignalStudy&&) noexcept = default;
SignalStudy::~SignalStudy() = default;

Result<SignalStudy> SignalStudy::create(const TraceInfo& info) {
  auto impl = std::make_unique<Impl>();
  impl->users.resize(info.users.size());
  for (std::size_t user = 0; user < info.users.size(); ++user) {
    const auto device = [&](Signal signal, std::string name, const DeviceCoding& coding) -> Result<void> {
      TACTUS_TRY(DeviceCoder coder, DeviceCoder::create(info, user, signal, std::move(name), coding));
      impl->devices.push_back(std::move(coder));
      return {};
    };
    const auto force = [&](std::string name, const ForceCoding& coding) -> Result<void> {
      TACTUS_TRY(ForceCoder coder, ForceCoder::create(info, user, std::move(name), coding));
      impl->forces.push_back(std::move(coder));
      return {};
    };
    TACTUS_CHECK(device(Signal::device, "every sample", {.every_tick = true}));
    for (const double length : kLengths) TACTUS_CHECK(device(Signal::device, millimetres(length), {.position = length}));
    for (const double p : kFractions)
      TACTUS_CHECK(
          device(Signal::contact, percent(p) + ", " + millimetres(kFreeLength), {.position = kFreeLength, .weber_fraction = p}));
    for (const double p : kFractions)
      TACTUS_CHECK(force(percent(p) + ", hold", {.predictor = ForcePredictor::hold, .weber_fraction = p}));
    for (const double p : kFractions)
      TACTUS_CHECK(force(percent(p) + ", linear", {.predictor = ForcePredictor::linear, .weber_fraction = p}));
    TACTUS_CHECK(force("IEEE 1918.1.1", {.rule = ForceRule::ieee1918}));
  }
  return SignalStudy(std::move(impl));
}

Result<void> SignalStudy::add(const TraceFrame& frame) {
  for (std::size_t i = 0; i < impl_->users.size(); ++i) {
    Impl::User& user = impl_->users[i];
    const UserSample& sample = frame.users[i];
    if (!user.first) user.first = sample.device.position;
    user.moves = user.moves || sample.device.position != *user.first;
    user.touches = user.touches || contact_of(sample, frame.objects);
    user.feels = user.feels || norm(sample.server_force) > 0;
  }
  for (DeviceCoder& coder : impl_->devices) {
    const UserSample& user = frame.users[coder.tally.result.user];
    TACTUS_CHECK(coder.add(frame.tick, user.device, contact_of(user, frame.objects)));
  }
  for (ForceCoder& coder : impl_->forces) TACTUS_CHECK(coder.add(frame.tick, frame.users[coder.tally.result.user].server_force));
  return {};
}

std::vector<SignalResult> SignalStudy::results() const {
  std::vector<SignalResult> out;
  const auto take = [&](const auto& coders) {
    for (const auto& coder : coders)
      if (impl_->has(coder.tally.result)) out.push_back(coder.tally.summary());
  };
  take(impl_->devices);
  take(impl_->forces);
  std::ranges::stable_sort(out, {}, &SignalResult::user);
  return out;
}

}  // namespace tactus::sim::study
