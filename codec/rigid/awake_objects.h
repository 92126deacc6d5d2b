// SPDX-License-Identifier: Apache-2.0
/// The objects that an encoder must look at in a tick: those that rest cost nothing. Internal to the library.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace tactus {

class AwakeObjects {
 public:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

  /// All sleep.   allocates 13 bytes per object
  explicit AwakeObjects(std::size_t objects) : is_awake_(objects, 0), due_(objects, kNever) {
    awake_.reserve(objects);
    alarms_.reserve(objects);
  }

  void wake(std::uint32_t object) noexcept {
    if (is_awake_[object] != 0) return;
    is_awake_[object] = 1;
    is_sorted_ = is_sorted_ && (awake_.empty() || awake_.back() < object);
    awake_.push_back(object);
  }
  void wake(std::span<const std::uint32_t> objects) noexcept {
    for (const std::uint32_t i : objects) wake(i);
  }
  /// Those whose time has come.
  void wake_due(std::int64_t tick) noexcept {
    while (!alarms_.empty() && alarms_.front().first <= tick) {
      const std::uint32_t object = alarms_.front().second;
      std::ranges::pop_heap(alarms_, std::greater{});
      alarms_.pop_back();
      due_[object] = kNever;
      wake(object);
    }
  }
  bool is_awake(std::uint32_t object) const noexcept { return is_awake_[object] != 0; }
  /// In ascending order.
  std::span<const std::uint32_t> objects() noexcept {
    if (!is_sorted_) std::ranges::sort(awake_);
    is_sorted_ = true;
    return awake_;
  }
  /// in   until(object)  the tick at which it wakes by itself, kNever; nothing: it stays awake
  template <class Until>
  void sleep(Until&& until) noexcept {
    std::erase_if(awake_, [&](std::uint32_t object) {
      const auto due = until(object);
      if (!due || (*due < due_[object] && !set_alarm(*due, object))) return false;
      is_awake_[object] = 0;
      return true;
    });
  }

 private:
  /// An object has one alarm at most; one that comes too early does no harm.   out  false: there is a later one
  bool set_alarm(std::int64_t due, std::uint32_t object) noexcept {
    if (due_[object] != kNever) return false;
    due_[object] = due;
    alarms_.emplace_back(due, object);
    std::ranges::push_heap(alarms_, std::greater{});
    return true;
  }

  std::vector<std::uint32_t> awake_;
  bool is_sorted_ = true;
  std::vector<std::uint8_t> is_awake_;
  std::vector<std::int64_t> due_;                               // of the alarm; kNever: none
  std::vector<std::pair<std::int64_t, std::uint32_t>> alarms_;  // a heap, the earliest first
};

}  // namespace tactus
