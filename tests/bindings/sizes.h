// SPDX-License-Identifier: Apache-2.0
/// Calls that take a struct with a size, called with structs of other versions.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <vector>

#include "tests/bindings/fixture.h"

namespace tactus::c_test {

enum class Direction { option, answer };

/// A struct of the interface: its sizes in all versions, which never change, and a call that takes it.
struct SizedCall {
  const char* name;
  std::size_t first;
  Direction direction;
  std::function<tactus_status(void* given, std::size_t size)> init;  ///< of options: as tactus_init()
  std::function<tactus_status(void* given, tactus_error* error)> call;
  std::vector<std::size_t> later{};  ///< of versions in which it has grown, rising

  std::size_t now() const { return later.empty() ? first : later.back(); }
};

template <class T, class Call>
auto taking(Call call) {
  return [call](void* given, tactus_error* error) { return call(static_cast<T*>(given), error); };
}
template <class T>
auto initialised() {
  return [](void* given, std::size_t size) { return init<T>(static_cast<T*>(given), size); };
}

/// A struct of this size and, behind it, what is not the library's to touch.
class Block {
 public:
  Block(const SizedCall& of, std::size_t size) : bytes_(std::max(size, sizeof(std::uint32_t)) + kGuard, kTouched) {
    std::fill(bytes_.begin(), bytes_.end() - kGuard, std::uint8_t{0});
    const bool is_made = of.init && of.init(data(), size) == TACTUS_OK;
    const auto stated = static_cast<std::uint32_t>(size);
    if (!is_made) std::memcpy(data(), &stated, sizeof stated);
  }
  std::uint8_t* data() { return bytes_.data(); }
  bool is_whole() const {
    return std::all_of(bytes_.end() - kGuard, bytes_.end(), [](std::uint8_t byte) { return byte == kTouched; });
  }

 private:
  static constexpr std::uint8_t kTouched = 0xa5;
  static constexpr std::ptrdiff_t kGuard = 64;
  std::vector<std::uint8_t> bytes_;
};

inline void expect_status(const SizedCall& of, std::size_t size, tactus_status wanted, std::uint8_t last) {
  Block block(of, size);
  if (size > of.now()) block.data()[size - 1] = last;
  tactus_error error{};
  const tactus_status status = of.call(block.data(), &error);
  EXPECT_EQ(status, wanted) << of.name << " of " << size << " bytes, the last " << int{last};
  EXPECT_TRUE(block.is_whole()) << of.name << " of " << size << " bytes";
  if (wanted != TACTUS_OK) {
    EXPECT_STREQ(error.rule == nullptr ? "none" : error.rule, "R-API-12") << of.name << " of " << size << " bytes";
  } else if (of.direction == Direction::answer && size > of.now()) {
    EXPECT_EQ(block.data()[size - 1], 0) << of.name << ": what the library does not know is 0";
  }
}

inline void check_sizes(const SizedCall& of) {
  constexpr std::size_t kMost = 4096;
  const std::size_t first = of.first, now = of.now();
  for (const std::size_t size : {first, now, now + 1, now + 8, kMost}) expect_status(of, size, TACTUS_OK, 0);
  for (const std::size_t size : of.later) {
    expect_status(of, size, TACTUS_OK, 0);
    expect_status(of, size - 1, TACTUS_INVALID_ARGUMENT, 0);
  }
  for (const std::size_t size : {std::size_t{0}, std::size_t{4}, first - 8, first - 1, kMost + 1})
    expect_status(of, size, TACTUS_INVALID_ARGUMENT, 0);
  const bool is_option = of.direction == Direction::option;
  for (const std::size_t size : {now + 1, now + 8, kMost})
    expect_status(of, size, is_option ? TACTUS_INVALID_ARGUMENT : TACTUS_OK, 1);
  if (!of.init) return;
  EXPECT_EQ(of.init(nullptr, now), TACTUS_INVALID_ARGUMENT) << of.name;
  for (const std::size_t size : {first - 1, first, now, now + 8, kMost, kMost + 1}) {
    std::vector<std::uint8_t> bytes(size + 8, 0xee);
    const bool fits = size >= first && size <= kMost;
    EXPECT_EQ(of.init(bytes.data(), size), fits ? TACTUS_OK : TACTUS_INVALID_ARGUMENT) << of.name << " of " << size;
    EXPECT_TRUE(std::all_of(bytes.end() - 8, bytes.end(), [](std::uint8_t byte) { return byte == 0xee; })) << of.name;
    if (!fits) continue;
    std::uint32_t stated = 0;
    std::memcpy(&stated, bytes.data(), sizeof stated);
    EXPECT_EQ(stated, size) << of.name;
    for (std::size_t i = now; i < size; ++i) ASSERT_EQ(bytes[i], 0) << of.name;
  }
}

}  // namespace tactus::c_test
