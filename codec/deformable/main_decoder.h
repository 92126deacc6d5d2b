// SPDX-License-Identifier: Apache-2.0
/// Profile main: decodes payloads into states, a function of payload and baseline. spec/50-deformable.md sections 5 to 7.
/// Internal to the library; Receiver is the way in.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <tactus/base/range_coder.h>
#include <tactus/base/rule.h>
#include <tactus/deformable/followed_shape.h>
#include <tactus/deformable/main_reader.h>
#include <tactus/packet/packet.h>
#include <tactus/scene/scene.h>

namespace tactus {

/// A codec of SubstreamDecoder.
class MainDecoder {
 public:
  using State = MainState;
  static constexpr RuleName kTickRule = "R-DEF-8";

  /// pre  `scene` outlives the decoder
  MainDecoder(const Scene& scene, const DeformableObject& object)
      : object_(object),
        baseline_span_(scene.baseline_span),
        reader_(object),
        next_(initial_main_state(object)),
        shown_(object.body ? object.rest.size() : 0) {}

  /// err  malformed R-RNG-4
  Result<PacketHead> read_head(std::span<const std::uint8_t> payload) noexcept;
  /// time O(vertices * (1 + modes)), 60 us for 714 vertices and 48 modes; no allocation.   err  malformed R-RNG-n; invalid R-DEF-9, 10
  Result<void> read_body(const MainState& base, std::int64_t tick, DecodedPacket& out) noexcept;
  void commit(const MainState&, MainState& next) noexcept { std::swap(next_, next); }
  std::uint64_t bit() const noexcept { return 8 * std::min<std::uint64_t>(coder_.position(), payload_); }

  void know(std::unique_ptr<FollowedShape> shape) noexcept { driven_ = std::move(shape); }  ///< pre  the object has a body
  /// Displacements shown at a tick not before the state's. Valid until the next call.
  std::span<const Vec3i> predict(const MainState& state, std::int64_t tick) noexcept;

 private:
  const DeformableObject& object_;
  std::uint8_t baseline_span_;
  MainReader reader_;
  RangeDecoder coder_{{}};
  std::uint64_t payload_ = 0;  // [bytes]
  MainModels models_;
  MainHead head_;
  MainState next_;                         // pending: no state changes before the whole packet has proved valid
  std::unique_ptr<FollowedShape> driven_;  // null: no device is known
  std::vector<Vec3i> shown_;               // of a state that follows the device
};

}  // namespace tactus
