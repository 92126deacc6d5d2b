// SPDX-License-Identifier: Apache-2.0
/// Counts what operator new hands out in this program, and makes it fail.
#pragma once

#include <cstdint>

namespace tactus::testing {

std::uint64_t allocated_bytes() noexcept;  ///< since the start; what was freed counts too
std::uint64_t live_blocks() noexcept;      ///< not freed yet

/// The call of operator new with this number, counted from here, throws; 0: none does.
void fail_allocation(std::uint64_t number) noexcept;
bool failure_is_due() noexcept;  ///< that call has not come yet

}  // namespace tactus::testing
