// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/main_state.h>

#include <algorithm>
#include <bit>
#include <cstdlib>

#include <tactus/base/bytes.h>
#include <tactus/base/fixed.h>

namespace tactus {

// ==== motion ====

namespace {

constexpr std::int64_t kLimit = 1 << 27;         // of a predicted increment
constexpr std::int64_t kProductLimit = 1 << 24;  // increments enter the correlations no larger than this
constexpr unsigned kFading = 5;                  // the correlations forget by 2^-5 per packet
constexpr unsigned kCoefficientBits = 12;

struct Coefficients {
  std::int64_t first = 0, second = 0;  // x 2^-12
};

/// Solve [11 12; 12 22] coefficients = [01; 02], slightly damped.
Coefficients coefficients_of(const std::array<std::int64_t, 5>& correlations) noexcept {
  std::uint64_t largest = 0;
  for (const std::int64_t s : correlations) largest = std::max(largest, static_cast<std::uint64_t>(std::abs(s)));
  const auto width = static_cast<unsigned>(std::bit_width(largest));
  const unsigned shift = width > 24 ? width - 24 : 0;
  std::array<std::int64_t, 5> s{};
  for (std::size_t i = 0; i < 5; ++i) s[i] = correlations[i] >> shift;
  s[0] += (s[0] >> 6) + 1;
  s[2] += (s[2] >> 6) + 1;
  const std::int64_t det = s[0] * s[2] - s[1] * s[1];
  if (det <= 0) return {};
  const auto tap = [det](std::int64_t numerator) {
    constexpr std::int64_t kTwo = 2 << kCoefficientBits;
    return std::clamp(round_div(numerator << kCoefficientBits, det), -kTwo, kTwo);
  };
  return {tap(s[3] * s[2] - s[4] * s[1]), tap(s[4] * s[0] - s[3] * s[1])};
}

}  // namespace

void ModeMotion::predict(std::uint32_t steps, std::span<std::int32_t> out) const noexcept {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const Channel& c = channels_[i];
    out[i] = 0;
    if (c.last == 0 && c.before == 0) continue;
    const Coefficients coefficients = coefficients_of(c.correlations);
    std::int64_t last = c.last, before = c.before, sum = 0;
    const std::int64_t bound = std::min(kLimit, 2 * std::max(std::abs(last), std::abs(before)));
    for (std::uint32_t n = 0; n < std::min(steps, kMaxSteps); ++n) {
      const std::int64_t next =
          std::clamp(round_shift(coefficients.first * last + coefficients.second * before, kCoefficientBits), -bound, bound);
      before = last;
      last = next;
      sum += next;
    }
    out[i] = static_cast<std::int32_t>(std::clamp(sum, -kLimit, kLimit));
  }
}

void ModeMotion::update(std::uint32_t steps, std::span<const std::int32_t> increments) noexcept {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    Channel& c = channels_[i];
    if (steps == 0) {
      c.last = saturate32(std::int64_t{c.last} + increments[i]);
      continue;
    }
    const auto now = static_cast<std::int32_t>(round_div(increments[i], steps));
    if (steps == 1) {
      const auto product = [](std::int64_t a, std::int64_t b) {
        return std::clamp(a, -kProductLimit, kProductLimit) * std::clamp(b, -kProductLimit, kProductLimit);
      };
      const std::array<std::int64_t, 5> products{product(c.last, c.last), product(c.last, c.before), product(c.before, c.before),
                                                 product(now, c.last), product(now, c.before)};
      for (std::size_t k = 0; k < 5; ++k) c.correlations[k] += products[k] - (c.correlations[k] >> kFading);
    }
    c.before = steps == 1 ? c.last : now;
    c.last = now;
  }
}

// ==== main state ====

namespace {

void add_to(Fnv1a& hash, std::span<const Vec3i> vectors) noexcept {
  for (const Vec3i& v : vectors)
    for (const std::int32_t c : v) hash.add32(c);
}

}  // namespace

MainState initial_main_state(const DeformableObject& object) {
  MainState state;
  state.displacement.resize(object.rest.size());
  state.motion = ModeMotion(object.basis.steps.size());
  if (object.fade > 0) state.off_basis.resize(object.rest.size());
  if (object.layered) state.haptic_correction.resize(object.rest.size());
  return state;
}

std::uint64_t state_hash(const DeformableObject& object, const MainState& state) noexcept {
  Fnv1a hash;
  hash.add64(static_cast<std::uint64_t>(state.tick));
  add_to(hash, state.displacement);
  hash.add32(state.visual);
  hash.add32(state.triangle);
  hash.add32(state.haptic);
  hash.add32(state.density | (state.touched ? 4u : 0u) | state.weight_set << 3 |
             static_cast<std::uint32_t>(state.following) << 5);
  state.motion.add_to(hash);
  if (object.layered) hash.add64(static_cast<std::uint64_t>(state.motion_tick));
  add_to(hash, state.haptic_correction);
  add_to(hash, state.off_basis);
  return hash.value();
}

std::uint32_t frame_steps(const DeformableObject& object, std::int64_t ticks) noexcept {
  return static_cast<std::uint32_t>(std::min<std::int64_t>(round_div(ticks << 8, object.frame_period), 0xffffffff));
}

std::uint32_t haptic_bound(std::uint32_t index) noexcept {
  constexpr std::array<std::uint64_t, 6> kMantissa{32768, 36781, 41285, 46341, 52016, 58386};  // 2^(15 + k / 6), rounded
  if (index == 0) return 0;
  return static_cast<std::uint32_t>((kMantissa[(index - 1) % 6] << ((index - 1) / 6)) >> 15);
}

ShapePredictor::ShapePredictor(const DeformableObject& object)
    : object_(object),
      increments_(object.basis.steps.size()),
      extrapolated_(increments_.size()),
      rounded_(object.basis.cluster_entries.size() == 0 ? 0 : increments_.size()),
      sum_(object.basis.entries.empty() ? 0 : 3 * object.rest.size()) {}

/// The same where most entries are 0.
void ShapePredictor::combine_clusters(std::span<const std::int32_t> coefficients, unsigned shift, std::span<Vec3i> out) noexcept {
  for (std::size_t k = 0; k < coefficients.size(); ++k)
    rounded_[k] = static_cast<std::int32_t>(round_shift(coefficients[k], shift));
  for (std::size_t v = 0; v < out.size(); ++v) {
    std::array<std::int64_t, 3> sum{};
    for (const ClusterEntry& entry : object_.basis.cluster_entries[v]) {
      const std::int32_t* g = rounded_.data() + ModeBasis::kClusterModes * entry.cluster;
      for (const std::int16_t value : entry.values)
        for (std::int64_t& s : sum) s += std::int64_t{value} * *g++;
    }
    for (std::size_t axis = 0; axis < 3; ++axis)
      out[v][axis] = limited_displacement(out[v][axis] + round_shift(sum[axis] << shift, 11));
  }
}

/// sum_ = modes * rounded coefficients. Four modes at a time, because to read and write the sum takes as long as to add one.
void ShapePredictor::sum_modes(std::span<const std::int32_t> coefficients, unsigned shift) noexcept {
  std::fill(sum_.begin(), sum_.end(), 0);
  std::array<std::int16_t, 4> g{};
  std::array<const std::int16_t*, 4> mode{};
  mode.fill(object_.basis.entries.data());
  std::size_t pending = 0;
  const auto add_pending = [&]() noexcept {
    for (std::size_t i = 0; i < sum_.size(); ++i)
      sum_[i] += (mode[0][i] * g[0] + mode[1][i] * g[1]) + (mode[2][i] * g[2] + mode[3][i] * g[3]);
    g.fill(0);
    pending = 0;
  };
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    g[pending] = static_cast<std::int16_t>(round_shift(coefficients[k], shift));
    if (g[pending] == 0) continue;
    mode[pending] = object_.basis.entries.data() + k * sum_.size();
    if (++pending == g.size()) add_pending();
  }
  if (pending > 0) add_pending();
}

/// out += modes * coefficients, all coefficients brought to 14 bits by one shift.
void ShapePredictor::combine(std::span<const std::int32_t> coefficients, std::span<Vec3i> out) noexcept {
  std::uint32_t largest = 0;
  for (const std::int32_t g : coefficients) largest = std::max(largest, static_cast<std::uint32_t>(std::abs(g)));
  if (largest == 0) return;
  const auto width = static_cast<unsigned>(std::bit_width(largest));
  const unsigned shift = width > 14 ? width - 14 : 0;
  if (object_.basis.cluster_entries.size() > 0) return combine_clusters(coefficients, shift, out);
  sum_modes(coefficients, shift);
  for (std::size_t v = 0; v < out.size(); ++v)
    for (std::size_t axis = 0; axis < 3; ++axis)
      out[v][axis] = limited_displacement(out[v][axis] + round_shift(static_cast<std::int64_t>(sum_[3 * v + axis]) << shift, 11));
}

void ShapePredictor::predict(const MainState& state, std::int64_t tick, std::span<Vec3i> out) noexcept {
  std::copy(state.displacement.begin(), state.displacement.end(), out.begin());
  if (state.motion.size() == 0) return;
  state.motion.predict(frame_steps(object_, tick - state.motion_tick), increments_);
  if (state.tick == state.motion_tick) return combine(increments_, out);
  state.motion.predict(frame_steps(object_, state.tick - state.motion_tick),
                       extrapolated_);  // where haptic layers have gone already
  for (std::size_t k = 0; k < extrapolated_.size(); ++k)
    extrapolated_[k] = limited_displacement(std::int64_t{increments_[k]} - extrapolated_[k]);
  combine(extrapolated_, out);
}

void ShapePredictor::add_modes(std::span<const std::int32_t> coefficients, std::span<Vec3i> out) noexcept {
  combine(coefficients, out);
  for (std::size_t k = 0; k < coefficients.size(); ++k)
    increments_[k] = limited_displacement(static_cast<std::int64_t>(increments_[k]) + coefficients[k]);
}

void ShapePredictor::update(const MainState& base, std::int64_t tick, MainState& next) const noexcept {
  next.motion = base.motion;
  next.motion.update(frame_steps(object_, tick - base.motion_tick), increments_);
  next.motion_tick = tick;
}

}  // namespace tactus
