// SPDX-License-Identifier: Apache-2.0
/// Meshes of profile thesis: decodes payloads into states, a function of payload and baseline. Internal to the library; Receiver is the
/// way in.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <tactus/base/bytes.h>
#include <tactus/base/rule.h>
#include <tactus/deformable/deformable_decoder.h>
#include <tactus/packet/packet.h>
#include <tactus/scene/scene.h>
#include <tactus/thesis/thesis_syntax.h>

namespace tactus {

/// A codec of SubstreamDecoder.
class ThesisDecoder {
 public:
  using State = ThesisState;
  static constexpr RuleName kTickRule = "R-DEF-8";

  /// pre  `scene` outlives the decoder
  ThesisDecoder(const Scene& scene, const DeformableObject& object);

  /// err  truncated, malformed R-DEF-11; invalid R-DEF-12
  Result<PacketHead> read_head(std::span<const std::uint8_t> payload) noexcept;
  /// time O(vertices), no allocation.   err  malformed R-RNG-n; invalid R-DEF-13
  Result<void> read_body(const ThesisState& base, std::int64_t tick, DecodedPacket& out) noexcept;
  void commit(const ThesisState&, ThesisState& next) noexcept { std::swap(next_, next); }
  std::uint64_t bit() const noexcept { return in_.bit_offset(); }

  std::span<const Vec3i> predict(const ThesisState& state, std::int64_t) const noexcept { return state.displacement; }

 private:
  struct ListedVertex {
    std::uint32_t vertex = 0;
    std::array<std::uint32_t, 3> symbol{};
  };

  Result<void> read_list(RangeDecoder coder) noexcept;

  const DeformableObject& object_;
  std::uint8_t baseline_span_;
  ByteReader in_{{}};
  ThesisHead head_;
  std::vector<BitModel> start_, models_;
  std::vector<ListedVertex> listed_;
  ThesisState next_;  // pending: no state changes before the whole packet has proved valid
};

/// DeformableDecoder::create of an object of profile thesis
std::unique_ptr<DeformableDecoder> thesis_mesh_decoder(const Scene& scene, std::size_t object, const DecodeLimits& limits);

}  // namespace tactus
