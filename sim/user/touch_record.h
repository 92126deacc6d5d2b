// SPDX-License-Identifier: Apache-2.0
/// Summary of a run at one user's hand: contacts, forces, and the energy of the port between device and scene (thesis 2.2.2).
#pragma once

#include <bitset>
#include <cstdint>
#include <optional>

#include <tactus/sim/scene/scene.h>
#include <tactus/sim/user/passivity.h>
#include <tactus/trace/frame.h>

namespace tactus::sim {

struct TouchSummary {
  std::uint64_t ticks = 0;     ///< in contact with anything, at the server
  std::uint64_t contacts = 0;  ///< begun
  std::uint32_t most_in_a_second =
      0;                     ///< contacts begun within one second: more than about ten is chattering, not the hand's motion
  double largest_force = 0;  ///< [N] felt
  /// [J] least net energy that the hand had put into the scene since a contact began, at most 0. A negative value means that the
  /// scene gave away more than it had taken. Sampling and delay cause this (eq. 2.2), and so do weight and other users, which
  /// have energy of their own. Each contact begins at 0, because energy taken by earlier ones would hide energy given by this
  /// one.
  double lowest_energy = 0;
  double stiffest = 0;                      ///< [N/m] largest stiffness of the couplings that held the hand
  std::optional<SurfaceContact> hardest{};  ///< where a deformable object was pressed with most force
};

class TouchRecord {
 public:
  /// One tick, as in the trace.   time O(1), no allocation
  void add(const UserSample& sample) noexcept;

  const TouchSummary& summary() const noexcept { return summary_; }

 private:
  TouchSummary summary_;
  PassivityObserver port_;
  bool touching_ = false;
  double hardest_ = 0;            // [N]
  std::bitset<kTickRate> began_;  // in each tick of the last second
  std::size_t tick_ = 0;          // of that second
  std::uint32_t in_a_second_ = 0;
};

}  // namespace tactus::sim
