// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tactus {

/// Why an object's state was sent. Values are wire values (spec/40-rigid.md table 1).
enum class Reason : std::uint8_t {
  request = 0,    ///< no trigger: a key packet or a stream without data reduction
  heartbeat = 1,  ///< time-out since the last update
  visual = 2,     ///< position or rotation error over the visual threshold (visual dead reckoning)
  haptic = 3,     ///< force error over the haptic threshold (haptic dead reckoning, thesis eq. 3.1)
};

}  // namespace tactus
