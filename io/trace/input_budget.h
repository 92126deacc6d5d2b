// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tactus {

/// What an untrusted input may make its reader work for: bytes that it unpacks to, or that must be handed out again because nothing
/// new was said of them. The first 64 MiB are free; beyond that every byte read earns 256. A factor as high as zstd's 32768 would
/// let a megabyte ask for minutes and for all memory.
class InputBudget {
 public:
  static constexpr std::uint64_t kFree = std::uint64_t{64} << 20;
  static constexpr std::uint64_t kEarnedByByte = 256;

  /// So many bytes were read.
  void earn(std::uint64_t bytes) noexcept { left_ += kEarnedByByte * bytes; }
  /// Ask for so many more; false, and nothing is spent, when they were not earned.
  [[nodiscard]] bool spend(std::uint64_t bytes) noexcept {
    if (bytes > left_) return false;
    left_ -= bytes;
    return true;
  }

 private:
  std::uint64_t left_ = kFree;
};

}  // namespace tactus
