// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tactus {

/// Lists of lists in one array: list i begins at items[first[i]].
template <class T>
struct ListOfLists {
  std::vector<std::uint32_t> first{0};
  std::vector<T> items;

  std::span<const T> operator[](std::size_t i) const noexcept {
    return std::span<const T>(items).subspan(first[i], first[i + 1] - first[i]);
  }
  std::size_t size() const noexcept { return first.size() - 1; }
  void close() { first.push_back(static_cast<std::uint32_t>(items.size())); }
  friend bool operator==(const ListOfLists&, const ListOfLists&) = default;
};

}  // namespace tactus
