// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tactus {

/// Work budget of an untrusted input: bytes that it unpacks to, and bytes of unchanged state that are handed out again. The first
/// 64 MiB are free; beyond that every byte read earns 256. A factor as high as zstd's 32768 would let one megabyte cost minutes
/// and all memory.
class InputBudget {
 public:
  static constexpr std::uint64_t kFree = std::uint64_t{64} << 20;
  static constexpr std::uint64_t kEarnedByByte = 256;

  /// Credit for `bytes` read.
  void earn(std::uint64_t bytes) noexcept { left_ += kEarnedByByte * bytes; }
  /// Spend `bytes`. Returns false and spends nothing if they were not earned.
  [[nodiscard]] bool spend(std::uint64_t bytes) noexcept {
    if (bytes > left_) return false;
    left_ -= bytes;
    return true;
  }

 private:
  std::uint64_t left_ = kFree;
};

}  // namespace tactus
