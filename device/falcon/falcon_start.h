// SPDX-License-Identifier: Apache-2.0
/// Brings an open Falcon to where it answers frames. Switched on it waits for its firmware, which is not free and comes with the vendor's
/// driver; it then runs until it is switched off. Internal to this library.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include <tactus/base/diagnostic.h>
#include <tactus/device/falcon/falcon_usb.h>

namespace tactus::device::falcon {

inline constexpr std::size_t kMostFirmware = 65536;  ///< bytes; those known have about 8000

/// Set the chip up, ask for a frame, and if none comes hand over the firmware. No frame exerts a force.
/// in   firmware  file; read only if it is needed
/// err  unsupported R-DEV-3 it needs firmware, and the file is not named, cannot be read, or does not run; io R-DEV-4 a transfer failed,
///      or no answer; malformed R-DEV-5 the answer is another one
/// time 0.2 s at most if its firmware runs, else about 3 s
tl::expected<void, Diagnostic> start(UsbPort& port, const std::string& firmware);

}  // namespace tactus::device::falcon
