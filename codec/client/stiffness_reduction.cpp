// SPDX-License-Identifier: Apache-2.0
#include <tactus/base/elementary.h>
#include <tactus/client/stiffness_reduction.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <numbers>
#include <utility>

#include <tactus/base/rule.h>

namespace tactus {

StiffnessReduction::StiffnessReduction(const Options& options)
    : as_printed_(options.as_printed), filter_(options.filter), path_(options.most_delay + std::size_t{1}) {}

Result<StiffnessReduction> StiffnessReduction::create(const Options& options) try {
  const bool has_delay = options.most_delay >= 1 && options.most_delay <= kMostDelay;
  const double filter = options.filter.value_or(1);
  if (!has_delay || !(filter > 0 && filter <= 1)) return fail(Errc::invalid_argument, "R-API-4");
  return StiffnessReduction(options);
} catch (const std::bad_alloc&) {
  return out_of_memory();
}

void StiffnessReduction::move(const Vec3& device) noexcept {
  path_[next_] = device;
  next_ = (next_ + 1) % path_.size();
  known_ = std::min(known_ + 1, path_.size());
}

/// [m] Of the device in the last round trip, as far as its path is known.
Vec3 StiffnessReduction::displacement(std::uint32_t round_trip) const noexcept {
  if (known_ == 0) return {};
  const std::size_t back = std::min<std::size_t>(round_trip, known_ - 1);
  const auto position = [this](std::size_t ago) -> const Vec3& { return path_[(next_ + path_.size() - 1 - ago) % path_.size()]; };
  return position(0) - position(back);
}

double StiffnessReduction::filtered(double wanted, double usual) noexcept {
  const double lambda = filter_.value_or(usual);
  mean_ = is_touching_ ? lambda * wanted + (1 - lambda) * mean_ : wanted;
  is_touching_ = true;
  return mean_;
}

double StiffnessReduction::reduced(const DeformableTouch& touch, std::uint32_t round_trip) noexcept {
  const double k = touch.coupling, follows = followed_fraction(touch.object_stiffness, k);
  const double stretch = -dot(touch.stretch, touch.normal), inwards = -dot(displacement(round_trip), touch.normal);
  double wanted = k;
  if (inwards > 0) wanted = inwards < stretch ? k * (1 - follows * inwards / stretch) : k * (1 - follows);
  return filtered(wanted, kFilter);
}

/// 4.27; without a hold the object can go anywhere.
static double blending(const Vec3& hold, const Vec3& normal) noexcept {
  const double length = norm(hold);
  if (!(length > 0)) return 1;
  return 2 / std::numbers::pi * arc_cosine(std::min(1.0, std::abs(dot(hold, normal)) / length));
}

/// The object's own damping (b_o of 4.29) is part of the load.
double StiffnessReduction::as_printed(const RigidTouch& touch, std::uint32_t round_trip) noexcept {
  constexpr std::uint32_t kVelocityTicks = 8;
  const double k = touch.coupling;
  const Vec3 moved = displacement(kVelocityTicks);
  const double ticks = static_cast<double>(std::min<std::size_t>(kVelocityTicks, std::max<std::size_t>(known_, 2) - 1));
  const auto late = static_cast<double>(std::min<std::size_t>(round_trip, path_.size() - 1));
  const double length = norm(moved), behind = blending(touch.hold, touch.normal) * k * late * length / ticks;
  if (!is_touching_) rendered_ = 0;
  double resists = 0;  // -f_r
  if (touch.moves) resists = length > 0 ? -dot(touch.external + touch.others, (1 / length) * moved) : 0;
  else if (rendered_ >= norm(touch.hold)) resists = norm(touch.hold);
  if (!std::exchange(is_touching_, true)) mean_ = k;
  const double stiffness = filtered(resists > 0 ? k * resists / (resists + behind) : k, kPrintedFilter);
  rendered_ = stiffness * norm(touch.stretch);
  return stiffness;
}

double StiffnessReduction::reduced(const RigidTouch& touch, std::uint32_t round_trip) noexcept {
  if (as_printed_) return as_printed(touch, round_trip);
  const double k = touch.coupling, stretch = norm(touch.stretch);
  const double usual = norm(touch.others) > 0 ? kSharedFilter : kFilter;
  if (!(stretch > 0)) return filtered(k, usual);
  const Vec3 push = (1 / stretch) * touch.stretch;
  const double resists = touch.moves ? -dot(touch.external, push) : norm(touch.hold);
  const double due = std::max(0.0, resists - dot(touch.others, push));
  const double behind = blending(touch.hold, touch.normal) * std::min(dot(displacement(round_trip), push), stretch - due / k);
  return filtered(behind > 0 ? k * due / (due + k * behind) : k, usual);
}

}  // namespace tactus
