// SPDX-License-Identifier: Apache-2.0
/// Decodes payloads of loads: a function of payload and baseline. spec/45-load.md 4. Internal to the library; Receiver is the way in.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/load/load_syntax.h>
#include <tactus/packet/packet.h>

namespace tactus {

/// A codec of SubstreamDecoder.
class LoadDecoder {
 public:
  using State = LoadState;
  static constexpr RuleName kTickRule = "R-LOD-1";

  /// pre  the scene has loads, and outlives the decoder
  explicit LoadDecoder(const Scene& scene);

  /// err  malformed R-RNG-4
  Result<PacketHead> read_head(std::span<const std::uint8_t> payload) noexcept;
  /// time O(vectors of the objects named); no allocation.   err  malformed R-RNG-n; invalid R-LOD-2, R-LOD-3
  Result<void> read_body(const LoadState& base, std::int64_t tick, DecodedPacket& out) noexcept;
  /// time O(vectors) where `next` is not `base`, else as read_body()
  void commit(const LoadState& base, LoadState& next) noexcept;
  std::uint64_t bit() const noexcept { return 8 * std::min<std::uint64_t>(coder_.position(), payload_); }

 private:
  Result<void> read_objects(const LoadState& base) noexcept;

  const Scene& scene_;
  RangeDecoder coder_{{}};
  std::uint64_t payload_ = 0;  // [bytes]
  LoadModels models_;
  LoadHead head_;
  std::vector<LoadStep> steps_;       // of one object
  std::vector<std::size_t> objects_;  // pending, by their index in Scene::moving()
  std::vector<Vec3i> vectors_;        // of these
};

}  // namespace tactus
