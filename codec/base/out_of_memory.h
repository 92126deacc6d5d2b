// SPDX-License-Identifier: Apache-2.0
/// Memory that cannot be had, as an error. Functions that return a Result let no exception out: those that allocate catch
/// std::bad_alloc and return this. Nothing has leaked then, and an object that was there before is as it was. Constructors, copies
/// and functions that return anything else throw. Internal to the libraries.
#pragma once

#include <new>

#include <tactus/base/rule.h>

namespace tactus {

inline tl::unexpected<Error> out_of_memory() noexcept { return fail(Errc::limit_exceeded, "R-API-11"); }

}  // namespace tactus
