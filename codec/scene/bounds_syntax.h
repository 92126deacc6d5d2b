// SPDX-License-Identifier: Apache-2.0
/// The extension record that holds a stream's bounds. spec/20-stream.md section 3.1. Internal to the library.
#pragma once

#include <cstdint>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/base/result.h>
#include <tactus/scene/scene_syntax.h>

namespace tactus {

inline constexpr std::uint64_t kBoundsRecord = 2;  ///< type of the record

/// R-STR-17: the bounds are those of the header's objects and meshes, their numbers finite and without a sign.   pre  there are bounds
bool are_bounds(const StreamHeader& header) noexcept;

/// Data of the record.   pre  are_bounds()
std::vector<std::uint8_t> write_bounds(StreamBounds bounds);

/// in   in      the record's data; what follows the elements that are known is skipped
///      header  with its objects and meshes
/// err  truncated, invalid R-STR-17
Result<StreamBounds> parse_bounds(ByteReader& in, const StreamHeader& header);

}  // namespace tactus
