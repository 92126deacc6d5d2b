// SPDX-License-Identifier: Apache-2.0
/// Inputs in one file, as pack.py makes it: records of name length, name, size and bytes, both numbers 32 bits, little-endian.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

/// Hand every input of a pack to `use`, in the pack's order.   out  false: the last record is cut off
template <class Use>
bool for_each_packed(std::span<const std::uint8_t> pack, Use use) {
  const auto take = [&pack](std::span<const std::uint8_t>& part) {
    if (pack.size() < 4) return false;
    std::size_t size = 0;
    for (std::size_t i = 0; i < 4; ++i) size |= std::size_t{pack[i]} << (8 * i);
    if (pack.size() - 4 < size) return false;
    part = pack.subspan(4, size);
    pack = pack.subspan(4 + size);
    return true;
  };
  while (!pack.empty()) {
    std::span<const std::uint8_t> name, bytes;
    if (!take(name) || !take(bytes)) return false;
    use(bytes);
  }
  return true;
}
