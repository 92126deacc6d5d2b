// SPDX-License-Identifier: Apache-2.0
/// How the ticks of a client's device follow those of the server, so that its packets arrive before they act: a policy of the server.
/// spec/65-signal.md section 4, informative part. Internal to the library.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include <tactus/session/datagram.h>

namespace tactus {

class DevicePace {
 public:
  explicit DevicePace(std::uint32_t tick_rate) noexcept
      : period_(2 * std::int64_t{tick_rate}), margin_((tick_rate + 499) / 500) {}

  /// A packet came.   in  device  its tick. Whether it is late is a matter of the pace: it may be held, and a packet too late to act
  ///                             though the pace is slow enough already
  void heard(std::int64_t device) noexcept {
    if (offset_) least_ = std::min(least_, device - (tick_ - *offset_));
  }

  /// What changes from this tick of the server on, if anything does.
  /// in   device  tick of the device that the fastest packets bring now
  std::optional<PacePart> step(std::int64_t tick, std::int64_t device) noexcept {
    const std::int64_t before = offset_.value_or(std::numeric_limits<std::int64_t>::min());
    tick_ = tick;
    if (!offset_) offset_ = tick - device + margin_;
    else if (least_ <= 0) *offset_ += 1 - least_;
    else if (tick < until_) return std::nullopt;
    else if (least_ > margin_ && least_ != kNone) --*offset_;
    until_ = tick + period_;
    least_ = kNone;
    if (*offset_ == before) return std::nullopt;
    const PacePart out{tick, *offset_};
    told_[next_++ % told_.size()] = {out, 0};
    waiting_ = std::min(waiting_ + 1, told_.size());
    return out;
  }

  /// Whether there are changes that the client may not know.
  bool waits() const noexcept { return waiting_ > 0; }
  /// Tell them in the datagram of this number.
  void tell(DatagramWriter& writer, std::uint64_t number) noexcept {
    for (std::size_t back = waiting_; back > 0; --back) {
      Told& told = told_[(next_ - back) % told_.size()];
      if (!writer.add(told.part)) return;
      if (told.number == 0) told.number = number;
    }
  }
  /// in   highest  number that the client has acknowledged
  void acknowledged(std::uint64_t highest) noexcept {
    while (waiting_ > 0) {
      const Told& oldest = told_[(next_ - waiting_) % told_.size()];
      if (oldest.number == 0 || oldest.number > highest) return;
      --waiting_;
    }
  }

 private:
  static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();
  struct Told {
    PacePart part;
    std::uint64_t number = 0;  // of the first datagram that told it; every one since did, too
  };

  std::int64_t period_, margin_;  // [ticks]
  std::optional<std::int64_t> offset_;
  std::int64_t tick_ = 0;       // of the last step
  std::int64_t least_ = kNone;  // [ticks] until a packet acts that came since the last change; 0 or less: too late
  std::int64_t until_ = 0;      // before this tick the pace does not get faster
  std::array<Told, 8> told_{};  // a ring
  std::size_t next_ = 0, waiting_ = 0;
};

}  // namespace tactus
