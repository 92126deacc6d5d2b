// SPDX-License-Identifier: Apache-2.0
/// What a decoder must know to have a use for a vector: the profiles of its deformable objects, and flags.
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::conformance {

struct Flag {
  const char* name;
  const char* meaning;
};

/// All flags there are, in the order in which they are listed.
std::span<const Flag> all_flags();

struct Features {
  std::set<std::string> profiles;
  std::set<std::string> flags;
};

/// Read from the bytes of a file as far as they make sense, whatever rule they break, and from the lines of its answer.
Features features(std::span<const std::uint8_t> file, std::string_view answer);

}  // namespace tactus::conformance
