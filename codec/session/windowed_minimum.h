// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace tactus {

/// The least of the samples of a time: of the newest tenth of the window, not all over, and the nine before.
class WindowedMinimum {
 public:
  /// in   window  [us]
  explicit WindowedMinimum(std::uint64_t window) noexcept : part_(window / kParts) {}

  /// True if the sample is the least now.   pre  `now` [us] never decreases
  bool add(std::int64_t sample, std::uint64_t now) noexcept {
    newest_ = now / part_ + 1;
    Part& part = parts_[newest_ % kParts];
    if (part.number != newest_) part = {sample, newest_};
    part.least = std::min(part.least, sample);
    return *value() == sample;
  }
  /// Nothing: there is no sample.
  std::optional<std::int64_t> value() const noexcept {
    std::optional<std::int64_t> out;
    for (const Part& part : parts_)
      if (part.number > 0 && part.number + kParts > newest_) out = std::min(out.value_or(part.least), part.least);
    return out;
  }

 private:
  static constexpr std::size_t kParts = 10;
  struct Part {
    std::int64_t least = 0;
    std::uint64_t number = 0;  // of this length of time since 0, + 1; 0: empty
  };
  std::uint64_t part_, newest_ = 0;
  std::array<Part, kParts> parts_{};
};

}  // namespace tactus
