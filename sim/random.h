// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tactus::sim {

/// SplitMix64 (Steele, Lea, Flood 2014): small, and unlike std:: distributions the same numbers with every standard library.
class Random {
 public:
  explicit constexpr Random(std::uint64_t seed) noexcept : state_(seed) {}

  constexpr std::uint64_t next() noexcept {
    state_ += 0x9E3779B97F4A7C15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }
  /// Uniform in [low, high), 53 random bits.
  constexpr double uniform(double low, double high) noexcept {
    return low + (high - low) * (static_cast<double>(next() >> 11) * 0x1p-53);
  }

 private:
  std::uint64_t state_;
};

}  // namespace tactus::sim
