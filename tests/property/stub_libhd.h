// SPDX-License-Identifier: Apache-2.0
/// Control of the stub of the vendor's runtime: tests find these functions in the loaded library.
#pragma once

#include <cstdint>

namespace tactus::testing {

struct StubState {
  std::uint64_t frames = 0;       ///< ended
  std::uint64_t pushes = 0;       ///< forces written that were other than zero
  std::uint64_t wrong_calls = 0;  ///< outside of a frame, with a wrong device, without output enabled ...
  double force[3] = {};           ///< [N] written last, the runtime's axes
  bool is_open = false, is_running = false;
};

using StubReset = void (*)();
/// The call of this function with this number, counted from 1, ends with an error.   in  function  "hdBeginFrame"
using StubFail = void (*)(const char* function, std::uint64_t number);
/// What the next frames return: a transform or a position that is none.
using StubSpoil = void (*)(bool spoils);
/// The thread does not call for so long.
using StubPause = void (*)(std::int64_t nanoseconds);
using StubLook = void (*)(StubState* out);

}  // namespace tactus::testing
