// SPDX-License-Identifier: Apache-2.0
/// Allocation failure as an error. Functions that return a Result never throw: those that allocate catch std::bad_alloc and
/// return this error. They leak nothing and leave existing objects unchanged. Constructors, copies and functions with any other
/// return type throw. Internal to the libraries.
#pragma once

#include <new>

#include <tactus/base/rule.h>

namespace tactus {

inline tl::unexpected<Error> out_of_memory() noexcept { return fail(Errc::limit_exceeded, "R-API-11"); }

}  // namespace tactus
