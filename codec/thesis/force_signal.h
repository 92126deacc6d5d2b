// SPDX-License-Identifier: Apache-2.0
/// The return channel of the CS-Force architecture (thesis 2.4.2.1): force vectors from the server to a client under the perceptual
/// deadband. For comparison with object states, and for use where a client cannot render. spec/85-thesis.md section 4.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>

namespace tactus {

/// When a sample is sent.
enum class ForceRule : std::uint8_t {
  weber,     ///< |f - f^| > p max(|f^|, floor)                    thesis eq. 2.8
  ieee1918,  ///< |f - f^| >= 0.1 (|f^| + 1e-5 N), zero-order hold: as in IEEE 1918.1.1
};

/// What the receiver shows between samples.
enum class ForcePredictor : std::uint8_t {
  hold,    ///< the last sample
  linear,  ///< on the line through the last two samples, for at most 50 ms
};

struct ForceCoding {
  ForceRule rule = ForceRule::weber;
  ForcePredictor predictor = ForcePredictor::hold;
  double weber_fraction = 0.08;  ///< p
  double floor = 0.05;           ///< [N] below this force the deadband stays p * floor
};

/// A force and its slope, on the grid of the wire: all that either end keeps.
struct ForceState {
  std::int64_t tick = 0;
  std::array<std::int32_t, 3> force{};  ///< x 2^-12 N
  std::array<std::int32_t, 3> slope{};  ///< x 2^-12 N per 1024 ticks
  friend bool operator==(const ForceState&, const ForceState&) = default;
};

inline constexpr unsigned kForceExp = 12;  ///< forces are multiples of 2^-12 N

/// The force at a tick.   [N]   pre  tick >= state.tick
Vec3 force_at(const ForceState& state, std::int64_t tick, std::uint32_t tick_rate) noexcept;

class ForceSender {
 public:
  static constexpr std::size_t kLargest = 40;  ///< [bytes] of a sample

  /// err  invalid_argument R-API-4: a fraction or floor is not finite and above 0, or the floor is finer than the grid
  static Result<ForceSender> create(const ForceCoding& coding, std::uint32_t tick_rate) noexcept;

  /// Look at the force of a tick; ticks rise.
  /// out  the sample to send, valid until the next call; empty: the receiver's force is within the deadband
  /// err  invalid_argument R-API-1, R-API-2: not finite, or above 4096 N; R-API-5: the order of ticks. Nothing changes
  /// time O(1), about 20 ns, no allocation
  Result<std::span<const std::uint8_t>> encode(std::int64_t tick, const Vec3& force) noexcept;
  const ForceState& state() const noexcept { return state_; }  ///< as the receiver has it

 private:
  ForceSender(const ForceCoding& coding, std::uint32_t tick_rate) noexcept : coding_(coding), tick_rate_(tick_rate) {}
  bool is_within(const Vec3& force, const Vec3& shown) const noexcept;

  ForceCoding coding_;
  std::uint32_t tick_rate_;
  ForceState state_;
  std::int64_t last_tick_ = -1;
  bool begun_ = false;
  std::array<std::uint8_t, kLargest> bytes_{};
};

/// Samples do not build on each other: any may be lost, and the newest one counts.
class ForceReceiver {
 public:
  explicit ForceReceiver(std::uint32_t tick_rate) noexcept : tick_rate_(tick_rate) {}

  /// err  truncated, malformed R-FRC-1; invalid R-FRC-2: a value out of range; state R-FRC-3: not newer than the newest. Nothing changes
  /// time O(1), no allocation
  Result<void> push(std::span<const std::uint8_t> sample) noexcept;
  Vec3 force(std::int64_t tick) const noexcept;  ///< [N] zero before the first sample, and at earlier ticks that of the newest
  const ForceState& state() const noexcept { return state_; }

 private:
  std::uint32_t tick_rate_;
  ForceState state_;
  bool begun_ = false;
};

}  // namespace tactus
