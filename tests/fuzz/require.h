// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>

/// Unlike assert, in every build.
inline void require(bool holds) {
  if (!holds) std::abort();
}
