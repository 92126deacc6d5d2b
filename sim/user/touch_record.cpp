// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/user/touch_record.h>

#include <algorithm>

namespace tactus::sim {

void TouchRecord::add(const UserSample& sample) noexcept {
  const bool touches = sample.contact.kind != ContactKind::none || sample.surface_contact;
  const bool begins = touches && !touching_;
  touching_ = touches;
  port_.arrive(sample.device.position);
  if (begins) port_.reset();
  port_.hold(sample.force);
  summary_.lowest_energy = port_.lowest();
  summary_.largest_force = std::max(summary_.largest_force, norm(sample.force));
  summary_.ticks += touches ? 1 : 0;
  summary_.contacts += begins ? 1 : 0;
  in_a_second_ += (begins ? 1U : 0U) - (began_[tick_] ? 1U : 0U);
  began_[tick_] = begins;
  tick_ = (tick_ + 1) % began_.size();
  summary_.most_in_a_second = std::max(summary_.most_in_a_second, in_a_second_);

  if (sample.contact.kind != ContactKind::none) summary_.stiffest = std::max(summary_.stiffest, sample.contact.stiffness);
  if (!sample.surface_contact) return;
  summary_.stiffest = std::max(summary_.stiffest, sample.surface_contact->stiffness);
  const double pressed = norm(sample.server_force);
  if (summary_.hardest && pressed <= hardest_) return;
  hardest_ = pressed;
  summary_.hardest = sample.surface_contact;
}

}  // namespace tactus::sim
