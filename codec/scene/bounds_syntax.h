// SPDX-License-Identifier: Apache-2.0
/// The extension record of a scene declaration that holds the stream's bounds. spec/20-scene.md section 6. Internal to the library.
#pragma once

#include <cstdint>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/base/result.h>
#include <tactus/scene/scene.h>

namespace tactus {

inline constexpr std::uint64_t kBoundsRecord = 2;  ///< type of the record

/// R-STR-17: the bounds match the scene's objects, their numbers are finite and carry no sign.   pre  there are bounds
bool are_bounds(const SceneSpec& spec) noexcept;

/// Data of the record.   pre  are_bounds()
std::vector<std::uint8_t> write_bounds(StreamBounds bounds);

/// in   in      the record's data; bytes after the known elements are skipped
///      spec  with its objects
/// err  truncated, invalid R-STR-17
Result<StreamBounds> parse_bounds(ByteReader& in, const SceneSpec& spec);

}  // namespace tactus
