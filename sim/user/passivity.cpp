// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/user/passivity.h>

namespace tactus::sim {

void PassivityObserver::arrive(const Vec3& position) noexcept {
  step_ = arrived_ ? position - position_ : Vec3{};
  energy_ -= dot(force_, step_);
  position_ = position;
  arrived_ = true;
  lowest_ = std::min(lowest_, energy_);
  violations_ += energy_ < -tolerance_ ? 1 : 0;
}

Vec3 PassivityController::limit(const Vec3& position, const Vec3& force) noexcept {
  port_.arrive(position);
  port_.cap(options_.max_stored);
  free_for_ = force == Vec3{} ? free_for_ + options_.tick : 0;
  if (free_for_ >= options_.reset_after) port_.reset();

  const Vec3& step = port_.step();
  const double missing = dot(force, step) - port_.energy(), step2 = dot(step, step);
  damping_ = missing > 0 && step2 > 0 ? std::min(missing * options_.tick / step2, options_.max_damping) : 0;
  const Vec3 shown = force - (damping_ / options_.tick) * step;
  port_.hold(shown);
  return shown;
}

}  // namespace tactus::sim
