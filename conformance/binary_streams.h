// SPDX-License-Identifier: Apache-2.0
/// Standard streams that pass every byte on as it is: Windows otherwise changes line ends, and ends the input at a byte 0x1a.
#pragma once

#ifdef _WIN32
#include <fcntl.h>
#include <io.h>
#endif

namespace tactus::conformance {

inline void use_binary_streams() {
#ifdef _WIN32
  for (const int stream : {0, 1}) _setmode(stream, _O_BINARY);
#endif
}

}  // namespace tactus::conformance
