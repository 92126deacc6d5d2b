// SPDX-License-Identifier: Apache-2.0
/// Stream header: what both ends must know before the first packet. spec/20-stream.md section 3.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/scene/bounds.h>
#include <tactus/scene/deformable_object.h>

namespace tactus {

enum class Profile : std::uint8_t { thesis = 0, main = 1 };

/// Fixed-point grids: a value v [SI] is the integer round(v * 2^exp).
///   field     quantity                unit        default   step at the default
///   position  position                m           22        0.24 um, range +-512 m
///   velocity  linear velocity         m/s         17        7.6 um/s
///   rotation  quarter-angle vector    1           20        0.95e-6 (3.8e-6 rad); |v| = tan(angle / 4)
///   spin      angular velocity        rad/s       12        0.24 mrad/s
struct GridExponents {
  std::uint8_t position = 22;
  std::uint8_t velocity = 17;
  std::uint8_t rotation = 20;
  std::uint8_t spin = 12;
  friend bool operator==(const GridExponents&, const GridExponents&) = default;
};

/// Degrees of freedom of a rigid object: world axes it may move along and turn about. No bit set: a static object, never sent.
/// Rotation is about no axis, one axis or all three (R-STR-12).
struct Dof {
  static constexpr std::uint8_t x = 1, y = 2, z = 4, rx = 8, ry = 16, rz = 32;
  static constexpr std::uint8_t none = 0, translation = 7, all = 63;
};

/// Integer pose and motion of one rigid object at one tick. This is all a decoder keeps per object.
struct RigidState {
  std::int64_t tick = 0;
  std::array<std::int32_t, 3> position{};                  ///< x 2^-position m
  std::array<std::int32_t, 4> rotation{1 << 30, 0, 0, 0};  ///< x 2^-30, Hamilton w, x, y, z
  std::array<std::int32_t, 3> velocity{};                  ///< x 2^-velocity m/s
  std::array<std::int32_t, 3> spin{};                      ///< x 2^-spin rad/s, world frame
  friend bool operator==(const RigidState&, const RigidState&) = default;
};

struct RigidObject {
  std::string name;  ///< UTF-8, 1..255 bytes
  std::uint8_t dof = Dof::all;
  RigidState initial;  ///< at rest at tick 0 (R-API-8); the state that key packets build on
};

struct StreamHeader {
  Profile profile = Profile::thesis;
  std::uint32_t tick_rate = 1000;  ///< ticks per second, 1 .. 1 000 000
  GridExponents grid;
  std::uint16_t max_extrapolation = 2000;  ///< ticks; an object without updates stops moving after so long
  std::uint8_t baseline_span = 1;          ///< how many of the newest states a receiver keeps as baselines, 1..64
  std::vector<RigidObject> objects;        ///< order is the wire order
  std::vector<DeformableObject> meshes;    ///< deformable objects; a stream without them has no byte about them
  std::optional<StreamBounds> bounds;      ///< what the sender vouches for; none: not told
};

/// What a decoder accepts before it allocates. What it takes is in proportion to the header's bytes that are there and to
/// state_bytes(), never to what is announced. A mesh of 2^20 vertices without a basis fits with a baseline_span of up to 19.
struct DecodeLimits {
  std::uint32_t objects = 4096;
  std::uint32_t header_bytes = 1u << 26;
  std::uint32_t packet_bytes = 1u << 26;
  std::uint32_t vertices = 1u << 20;       ///< of all meshes
  std::uint32_t triangles = 1u << 21;      ///< of all meshes
  std::uint64_t state_bytes = 1ull << 28;  ///< of all states that the stream's decoders keep
};

/// What the states take that decoders of all parts of a stream keep [bytes]. spec/20-stream.md section 5
std::uint64_t state_bytes(const StreamHeader& header) noexcept;

/// Everything but the meshes, without copying them.
StreamHeader without_meshes(const StreamHeader& header);

/// Serialise a header. Deterministic: equal headers give equal bytes.
/// err  invalid_argument with the R-STR rule that the header breaks.
Result<std::vector<std::uint8_t>> write_header(const StreamHeader& header);

/// What a stream promises whose encoders have these thresholds: meshes of profile thesis only aim at theirs.
StreamBounds bounds_of(const StreamHeader& header, const RigidTriggers& rigid, const DeformableThresholds& meshes);

/// The rule that a header breaks, if any. Both write_header and every create() check it.
Result<void> check_header(const StreamHeader& header, const DecodeLimits& limits = {});

/// A parsed header and the number of bytes it took.
struct ParsedHeader {
  StreamHeader header;
  std::size_t size = 0;
};

/// Parse a header from the front of `bytes`; unknown extension records are skipped.
/// err  truncated, malformed, invalid, unsupported, limit_exceeded, checksum: R-STR-1 .. R-STR-18, R-MES-1 .. R-MES-7.
Result<ParsedHeader> parse_header(std::span<const std::uint8_t> bytes, const DecodeLimits& limits = {});

/// Upper bound of the size of any packet of this stream's rigid objects, in bytes.
std::size_t max_packet_size(const StreamHeader& header) noexcept;
/// The same of one mesh.
std::size_t max_deformable_packet_size(const DeformableObject& mesh) noexcept;

}  // namespace tactus
