// SPDX-License-Identifier: Apache-2.0
#include <tactus/thesis/force_signal.h>

#include <algorithm>
#include <cmath>

#include <tactus/base/bytes.h>
#include <tactus/base/fixed.h>
#include <tactus/base/rule.h>
#include <tactus/packet/substream.h>

namespace tactus {
namespace {

constexpr std::int64_t kLargestForce = std::int64_t{4096} << kForceExp, kLargestSlope = std::int64_t{1} << 30;
constexpr unsigned kSlopeShift = 10;  // slopes are per 1024 ticks

constexpr std::int64_t reach(std::uint32_t tick_rate) noexcept { return std::max<std::int64_t>(1, tick_rate / 20); }

/// spec/85-thesis.md section 4: integers.
std::array<std::int32_t, 3> shown_at(const ForceState& state, std::int64_t tick, std::uint32_t tick_rate) noexcept {
  const std::int64_t dt = std::clamp<std::int64_t>(tick - state.tick, 0, reach(tick_rate));
  std::array<std::int32_t, 3> out{};
  for (std::size_t a = 0; a < 3; ++a)
    out[a] = saturate32(state.force[a] + round_shift(std::int64_t{state.slope[a]} * dt, kSlopeShift));
  return out;
}

Vec3 to_newton(const std::array<std::int32_t, 3>& force) noexcept {
  return {std::ldexp(force[0], -12), std::ldexp(force[1], -12), std::ldexp(force[2], -12)};
}

std::array<std::int32_t, 3> to_grid(const Vec3& force) noexcept {
  const auto one = [](double value) { return static_cast<std::int32_t>(std::floor(std::ldexp(value, kForceExp) + 0.5)); };
  return {one(force.x), one(force.y), one(force.z)};
}

}  // namespace

Vec3 force_at(const ForceState& state, std::int64_t tick, std::uint32_t tick_rate) noexcept {
  return to_newton(shown_at(state, tick, tick_rate));
}

Result<ForceSender> ForceSender::create(const ForceCoding& coding, std::uint32_t tick_rate) noexcept {
  const bool valid = coding.weber_fraction > 0 && coding.weber_fraction <= 10 && coding.floor > 0 && coding.floor <= 1e3 &&
                     coding.weber_fraction * coding.floor >= std::ldexp(1.0, -static_cast<int>(kForceExp)) && tick_rate > 0;
  if (!valid) return fail(Errc::invalid_argument, "R-API-4");
  ForceCoding out = coding;
  if (coding.rule == ForceRule::ieee1918) out.predictor = ForcePredictor::hold;
  return ForceSender(out, tick_rate);
}

bool ForceSender::is_within(const Vec3& force, const Vec3& shown) const noexcept {
  constexpr double kFraction = 0.1, kEpsilon = 1e-5;  // IEEE 1918.1.1
  const double error = norm(force - shown);
  if (coding_.rule == ForceRule::ieee1918) return error < kFraction * (norm(shown) + kEpsilon);
  return error <= coding_.weber_fraction * std::max(norm(shown), coding_.floor);
}

Result<std::span<const std::uint8_t>> ForceSender::encode(std::int64_t tick, const Vec3& force) noexcept {
  if (!is_finite(force)) return fail(Errc::invalid_argument, "R-API-1");
  if (!(norm(force) <= 4096)) return fail(Errc::invalid_argument, "R-API-2");
  if (tick <= last_tick_ || tick >= kTickLimit) return fail(Errc::invalid_argument, "R-API-5");
  last_tick_ = tick;
  const std::array<std::int32_t, 3> wanted = to_grid(force);
  const std::array<std::int32_t, 3> shown = shown_at(state_, tick, tick_rate_);
  // What the grid cannot distinguish is not sent.
  if (wanted == shown || is_within(force, to_newton(shown))) return std::span<const std::uint8_t>();
  ForceState next{.tick = tick, .force = wanted};
  if (coding_.predictor == ForcePredictor::linear && begun_) {
    const std::int64_t dt = tick - state_.tick;
    for (std::size_t a = 0; a < 3 && dt <= reach(tick_rate_); ++a)
      next.slope[a] = static_cast<std::int32_t>(
          std::clamp(round_div((std::int64_t{wanted[a]} - state_.force[a]) << kSlopeShift, dt), -kLargestSlope, kLargestSlope));
  }
  std::size_t size = 0;
  const auto put = [&](std::uint64_t value) {
    for (; value >= 0x80; value >>= 7) bytes_[size++] = static_cast<std::uint8_t>(value | 0x80);
    bytes_[size++] = static_cast<std::uint8_t>(value);
  };
  const bool slopes = next.slope != std::array<std::int32_t, 3>{};
  put(2 * static_cast<std::uint64_t>(tick) + (slopes ? 1 : 0));
  for (const std::int32_t f : next.force) put(zigzag(f));
  for (std::size_t a = 0; a < 3 && slopes; ++a) put(zigzag(next.slope[a]));
  state_ = next;
  begun_ = true;
  return std::span<const std::uint8_t>(bytes_).first(size);
}

Result<void> ForceReceiver::push(std::span<const std::uint8_t> sample) noexcept {
  ByteReader reader(sample);
  const std::uint64_t head = reader.varint();
  ForceState next{.tick = static_cast<std::int64_t>(head / 2)};
  bool within = head / 2 < static_cast<std::uint64_t>(kTickLimit), flat = true;
  const auto read = [&](std::int64_t limit) {
    const std::int64_t value = unzigzag(reader.varint());
    within = within && value >= -limit && value <= limit;
    return static_cast<std::int32_t>(std::clamp(value, -limit, limit));
  };
  for (std::int32_t& f : next.force) f = read(kLargestForce);
  for (std::size_t a = 0; a < 3 && head % 2 == 1; ++a) flat = (next.slope[a] = read(kLargestSlope)) == 0 && flat;
  if (reader.overrun()) return fail(Errc::truncated, "R-FRC-1", reader.bit_offset());
  if (reader.overlong() || reader.remaining() > 0 || (head % 2 == 1 && flat))
    return fail(Errc::malformed, "R-FRC-1", reader.bit_offset());
  if (!within) return fail(Errc::invalid, "R-FRC-2");
  if (begun_ && next.tick <= state_.tick) return fail(Errc::state, "R-FRC-3");
  state_ = next;
  begun_ = true;
  return {};
}

Vec3 ForceReceiver::force(std::int64_t tick) const noexcept { return force_at(state_, tick, tick_rate_); }

}  // namespace tactus
