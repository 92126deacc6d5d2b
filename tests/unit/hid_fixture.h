// SPDX-License-Identifier: Apache-2.0
/// Report descriptors as devices have them, item by item.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <vector>

namespace tactus::testing {

using Bytes = std::vector<std::uint8_t>;

inline Bytes joined(std::initializer_list<Bytes> parts) {
  Bytes out;
  for (const Bytes& part : parts) out.insert(out.end(), part.begin(), part.end());
  return out;
}

inline const Bytes kDesktop{0x05, 0x01}, kControllerBegins{0x05, 0x01, 0x09, 0x08, 0xa1, 0x01}, kPhysical{0xa1, 0x00}, kEnd{0xc0};
inline const Bytes kSixteenBits{0x75, 0x10}, kThree{0x95, 0x03}, kSix{0x95, 0x06}, kInputs{0x81, 0x02};
inline const Bytes kXyz{0x09, 0x30, 0x09, 0x31, 0x09, 0x32}, kTurns{0x09, 0x33, 0x09, 0x34, 0x09, 0x35};
inline const Bytes kCapRange{0x16, 0xa2, 0xfe, 0x26, 0x5e, 0x01,  // -350..350 are
                             0x36, 0x88, 0xfa, 0x46, 0x78, 0x05,  // -1400..1400
                             0x55, 0x0c, 0x65, 0x11};             // 10^-4 cm
inline const Bytes kTwoButtons{0xa1, 0x02, 0x85, 0x03, 0x05, 0x09, 0x19, 0x01, 0x29, 0x02, 0x15, 0x00, 0x25, 0x01, 0x35,
                               0x00, 0x45, 0x01, 0x75, 0x01, 0x95, 0x02, 0x81, 0x02, 0x95, 0x0e, 0x81, 0x03, 0xc0};
inline const Bytes kLamp{0xa1, 0x02, 0x85, 0x04, 0x05, 0x08, 0x09, 0x4b, 0x95, 0x01, 0x91, 0x02, 0x75, 0x07, 0x91, 0x03, 0xc0};

/// Shifts in report 1, turns in report 2, two buttons in report 3, a lamp in report 4.
inline Bytes older_mouse() {
  return joined({kControllerBegins,
                 kPhysical,
                 {0x85, 0x01},
                 kCapRange,
                 kXyz,
                 kSixteenBits,
                 kThree,
                 {0x81, 0x06},
                 kEnd,
                 kPhysical,
                 {0x85, 0x02},
                 kTurns,
                 kSixteenBits,
                 kThree,
                 {0x81, 0x06},
                 kEnd,
                 kTwoButtons,
                 kLamp,
                 kEnd});
}

/// All six in report 1.
inline Bytes newer_mouse() {
  return joined({kControllerBegins,
                 kPhysical,
                 {0x85, 0x01},
                 kCapRange,
                 kXyz,
                 kTurns,
                 kSixteenBits,
                 kSix,
                 kInputs,
                 kEnd,
                 kTwoButtons,
                 kEnd});
}

/// Six bytes without an id: shifts in inches, turns in degrees, then eight buttons.
inline Bytes plain_controller() {
  return joined({kControllerBegins,
                 {0x15, 0x00, 0x25, 0xff, 0x35, 0x00, 0x45, 0x02, 0x65, 0x13, 0x75, 0x08},
                 kThree,
                 kXyz,
                 kInputs,
                 {0x35, 0xa6, 0x45, 0x5a, 0x65, 0x14},
                 kTurns,
                 kInputs,
                 {0x05, 0x09, 0x19, 0x01, 0x29, 0x08, 0x25, 0x01, 0x75, 0x01, 0x95, 0x08},
                 kInputs,
                 kEnd});
}

/// It has six axes, too, but is played with.
inline Bytes gamepad() {
  Bytes out = plain_controller();
  out[3] = 0x05;
  return out;
}

}  // namespace tactus::testing
