// SPDX-License-Identifier: Apache-2.0
/// One sample of a force-feedback device. Virtual hands, recordings and real devices deliver it. Quantities that a device does
/// not sense keep their defaults.
#pragma once

#include <cstdint>

#include <tactus/base/geometry.h>

namespace tactus {

/// symbol       shape  unit  frame
/// position     3      m     world: x_d
/// orientation  4      1     world: of the handle, unit length
/// velocity     3      m/s   world: as the device measures it
/// buttons             1     bit i is set while button i is down
/// time                ns    on the device's own clock, from any origin, not negative
struct DeviceSample {
  Vec3 position;
  Quat orientation{};
  Vec3 velocity{};
  std::uint32_t buttons = 0;
  std::int64_t time = 0;

  bool is_down(unsigned button) const noexcept { return (buttons >> button & 1u) != 0; }
};

/// Which quantities a device senses besides its position.
struct DeviceSenses {
  bool orientation = false;
  bool velocity = false;
  bool buttons = false;
  bool time = false;
  friend bool operator==(const DeviceSenses&, const DeviceSenses&) = default;
};

/// Finite, not before the clock's origin, and the orientation of unit length within what single precision and printed digits lose.
inline bool is_valid(const DeviceSample& sample) noexcept {
  const auto& [w, x, y, z] = sample.orientation;
  const double off_unit = w * w + x * x + y * y + z * z - 1;
  return is_finite(sample.position) && is_finite(sample.velocity) && off_unit >= -1e-3 && off_unit <= 1e-3 && sample.time >= 0;
}

}  // namespace tactus
