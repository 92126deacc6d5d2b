// SPDX-License-Identifier: Apache-2.0
/// Counts calls of malloc in this program (Eigen's matrices do not come from operator new), and in SuiteSparse where that is used.
/// pre  linked with -Wl,--wrap=malloc
#pragma once

#include <cstdint>

namespace tactus::testing {

std::uint64_t heap_calls() noexcept;  ///< since the start

}  // namespace tactus::testing
