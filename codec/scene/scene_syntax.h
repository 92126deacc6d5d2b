// SPDX-License-Identifier: Apache-2.0
/// A scene declaration as bytes: the head of a stream file and the first message of a session. spec/20-scene.md sections 2 to 6.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/scene/scene.h>

namespace tactus {

inline constexpr std::uint8_t kFormatVersion = 2;  ///< of what is written, and the only one that is read

/// Deterministic: equal scenes give equal bytes.   err  limit_exceeded R-API-11: out of memory
Result<std::vector<std::uint8_t>> write_scene(const Scene& scene);

/// A scene and the number of bytes that its declaration took.
struct ParsedScene {
  SharedScene scene;
  std::size_t size = 0;
};

/// Parse a declaration from the front of `bytes`; unknown extension records are skipped.
/// err  truncated, malformed, invalid, unsupported, limit_exceeded, checksum: R-STR-1 .. R-STR-18, R-DEF-1 .. R-DEF-7.
Result<ParsedScene> parse_scene(std::span<const std::uint8_t> bytes, const DecodeLimits& limits = {});

}  // namespace tactus
