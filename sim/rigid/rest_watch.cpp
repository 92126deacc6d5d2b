// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/rigid/rest_watch.h>

namespace tactus::sim {

void RestWatch::add(const Pose& pose, double reach) {
  objects_.push_back({.before = pose, .reach = reach, .pile = objects_.size()});
}

std::size_t RestWatch::pile_of(std::size_t object) noexcept {
  while (objects_[object].pile != object) object = objects_[object].pile = objects_[objects_[object].pile].pile;
  return object;
}

void RestWatch::end_period(std::span<const Pose> poses) noexcept {
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    Watched& object = objects_[i];
    const double moved = norm(poses[i].position - object.before.position) +
                         object.reach * angle_between(object.before.rotation, poses[i].rotation);
    Watched& pile = objects_[pile_of(i)];
    ++pile.members;
    pile.restless = pile.restless || object.disturbed || !(moved < kRestDistance);
    object.before = poses[i];
  }
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const Watched& pile = objects_[pile_of(i)];
    objects_[i].rests = pile.members > 1 && !pile.restless;
  }
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    Watched& object = objects_[i];
    object.pile = i;
    object.members = 0;
    object.disturbed = object.restless = false;
  }
}

}  // namespace tactus::sim
