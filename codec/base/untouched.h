// SPDX-License-Identifier: Apache-2.0
/// Room for the worst case that costs memory only where it is used. Internal to the library.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace tactus {

/// An allocator whose vectors do not write to elements of no given value: a large one takes no memory before it is used.
template <class T>
struct Untouched : std::allocator<T> {
  template <class U, class... Values>
  void construct(U* at, Values&&... values) {
    if constexpr (sizeof...(Values) == 0) ::new (static_cast<void*>(at)) U;
    else std::construct_at(at, std::forward<Values>(values)...);
  }
};

using UntouchedBytes = std::vector<std::uint8_t, Untouched<std::uint8_t>>;

}  // namespace tactus
