// SPDX-License-Identifier: Apache-2.0
/// Counts what operator new hands out in this program.
#pragma once

#include <cstdint>

namespace tactus::testing {

std::uint64_t allocated_bytes() noexcept;  ///< since the start; what was freed counts too

}  // namespace tactus::testing
