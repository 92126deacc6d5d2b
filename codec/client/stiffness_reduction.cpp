// SPDX-License-Identifier: Apache-2.0
#include <tactus/client/stiffness_reduction.h>

#include <algorithm>
#include <new>

#include <tactus/base/out_of_memory.h>
#include <tactus/base/rule.h>

namespace tactus {

Result<StiffnessReduction> StiffnessReduction::create(const Options& options) try {
  const bool has_delay = options.most_delay >= 1 && options.most_delay <= kMostDelay;
  if (!has_delay || !(options.filter > 0 && options.filter <= 1)) return fail(Errc::invalid_argument, "R-API-4");
  return StiffnessReduction(options);
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

void StiffnessReduction::move(const Vec3& device) noexcept {
  path_[next_] = device;
  next_ = (next_ + 1) % path_.size();
  known_ = std::min(known_ + 1, path_.size());
}

/// pre  known_ > 0
const Vec3& StiffnessReduction::place(std::uint32_t ago) const noexcept {
  const std::size_t back = 1 + std::min<std::size_t>(ago, known_ - 1);
  return path_[(next_ + path_.size() - back) % path_.size()];
}

double StiffnessReduction::reduced(const Touch& touch, std::uint32_t round_trip) noexcept {
  const double k = touch.coupling, follows = k / (touch.object_stiffness + k);
  const double stretch = -dot(touch.stretch, touch.normal);
  const double way = known_ == 0 ? 0 : -dot(place(0) - place(round_trip), touch.normal);
  double wanted = k;
  if (way > 0) wanted = way < stretch ? k * (1 - follows * way / stretch) : k * (1 - follows);
  mean_ = is_touching_ ? filter_ * wanted + (1 - filter_) * mean_ : wanted;
  is_touching_ = true;
  return mean_;
}

}  // namespace tactus
