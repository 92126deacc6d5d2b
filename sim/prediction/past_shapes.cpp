// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/prediction/past_shapes.h>

#include <algorithm>
#include <cmath>

namespace tactus::sim {
namespace {

std::int32_t in_steps(float metres) noexcept {
  constexpr float kSteps = 1U << PastShapes::kExp;
  return static_cast<std::int32_t>(std::lround(std::clamp(kSteps * metres, -1e9F, 1e9F)));
}

}  // namespace

PastShapes::PastShapes(std::size_t vertices, double ticks, double period)
    : size_(3 * vertices),
      period_(period),
      ticks_(static_cast<std::size_t>(std::ceil(ticks / period)) + 2, INT64_MIN / 2),
      shapes_(size_ * ticks_.size()),
      offset_(size_),
      heard_(size_),
      shown_(vertices) {}

void PastShapes::add(std::int64_t tick, std::span<const float> displacements) noexcept {
  next_ = (next_ + 1) % ticks_.size();
  ticks_[next_] = tick;
  std::ranges::copy(displacements, shapes_.begin() + static_cast<std::ptrdiff_t>(next_ * size_));
}

void PastShapes::hear(std::span<const Displacement> displacements, unsigned position_exp, double age) noexcept {
  const auto metres = static_cast<float>(std::ldexp(1.0, -static_cast<int>(position_exp)));
  for (std::size_t i = 0; i < size_; ++i) heard_[i] = metres * static_cast<float>(displacements[i / 3][i % 3]);
  age_ = age;
}

void PastShapes::compare(double tick, double share) noexcept {
  std::size_t before = 0;
  while (before + 1 < ticks_.size() && static_cast<double>(tick_back(before)) > tick) ++before;
  const std::size_t after = before > 0 ? before - 1 : 0;
  // Between two shapes it moves; after a longer rest, in the last period of it.
  const double way = std::clamp(1 - (static_cast<double>(tick_back(after)) - tick) / period_, 0.0, 1.0);
  const auto part = static_cast<float>(way), taken = static_cast<float>(share);
  const float *a = back(before), *b = back(after);
  for (std::size_t i = 0; i < size_; ++i) {
    const float own = a[i] + part * (b[i] - a[i]);
    offset_[i] += taken * (heard_[i] - own - offset_[i]);
  }
  age_ = -1;
}

void PastShapes::show() noexcept {
  const float* own = back(0);
  for (std::size_t i = 0; i < size_; ++i) shown_[i / 3][i % 3] = in_steps(own[i] + offset_[i]);
}

void PastShapes::show_heard() noexcept {
  for (std::size_t i = 0; i < size_; ++i) shown_[i / 3][i % 3] = in_steps(heard_[i]);
  age_ = -1;
}

}  // namespace tactus::sim
