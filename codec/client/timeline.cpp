// SPDX-License-Identifier: Apache-2.0
#include <tactus/client/timeline.h>

#include <algorithm>
#include <tuple>

#include <tactus/base/fixed.h>
#include <tactus/rigid/curve.h>

namespace tactus {

// ==== timeline ====

namespace {

bool is_before(const Timeline::Update& a, const Timeline::Update& b) noexcept {
  return std::tie(a.state.tick, a.number) < std::tie(b.state.tick, b.number);
}

}  // namespace

void Timeline::reset(const RigidState& initial) noexcept {
  updates_[0] = {0, initial};
  count_ = 1;
}

void Timeline::add(const Update& update) noexcept {
  std::size_t at = count_;
  while (at > 0 && is_before(update, updates_[at - 1])) --at;
  const auto begin = updates_.begin();
  if (count_ < kMost) {
    std::move_backward(begin + at, begin + count_, begin + count_ + 1);
    ++count_;
  } else {
    if (at == 0) return;
    std::move(begin + 1, begin + at, begin);
    --at;
  }
  updates_[at] = update;
}

Timeline::Around Timeline::around(std::int64_t tick) const noexcept {
  std::size_t after = count_;
  while (after > 0 && updates_[after - 1].state.tick > tick) --after;
  const std::size_t before = after > 0 ? after - 1 : 0;
  return {updates_[before], before + 1 < count_ ? &updates_[before + 1] : nullptr};
}

void HeardPackets::add(std::uint64_t number) noexcept {
  if (newest_ == 0 || number > newest_ + kReach) {
    bits_ = {};
    newest_ = number;
  }
  for (; newest_ < number; bits_[word(newest_)] &= ~(std::uint64_t{1} << (newest_ % 64))) ++newest_;
  if (newest_ - number < kReach) bits_[word(number)] |= std::uint64_t{1} << (number % 64);
}

bool HeardPackets::all_between(std::uint64_t first, std::uint64_t last) const noexcept {
  if (last > first + kReach) return false;
  for (std::uint64_t number = first + 1; number < last; ++number)
    if (!has(number)) return false;
  return true;
}

// ==== bend ====

RigidPose bend(const Scene& scene, const RigidState& a, const RigidState& b, std::int64_t tick) noexcept {
  const RigidPredictor predictor(scene);
  const std::int64_t whole = b.tick - a.tick;
  const std::int64_t share = round_div((tick - a.tick) << 30, whole);
  const Cubic curve = cubic(share);
  const bool is_moving = !is_zero(a.velocity) || !is_zero(b.velocity);
  const bool is_turning = !is_zero(a.angular_velocity) || !is_zero(b.angular_velocity);
  const PoseOffset error = offset_between(predictor.pose(a, b.tick), {b.position, b.rotation});
  const PoseOffset change = change_between(scene, predictor.motion(a, b.tick, {}), {b.velocity, b.angular_velocity}, whole);
  return displaced(predictor.pose(a, tick), error, change,
                   {is_moving ? curve.error : share, is_turning ? curve.error : share, curve.change});
}

}  // namespace tactus
