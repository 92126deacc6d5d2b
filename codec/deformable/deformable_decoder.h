// SPDX-License-Identifier: Apache-2.0
/// Decoder of deformable objects: profile main, and the interface to both profiles. Internal to the library.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <tactus/base/range_coder.h>
#include <tactus/base/result.h>
#include <tactus/base/rule.h>
#include <tactus/deformable/main_state.h>
#include <tactus/deformable/main_syntax.h>
#include <tactus/deformable/vertex_coder.h>
#include <tactus/packet/packet.h>
#include <tactus/packet/substream_decoder.h>
#include <tactus/scene/scene.h>

namespace tactus {

// ==== main reader ====
// Reads a packet of profile main from any symbol source: the decoder's range decoder, or one that counts (tests/tools). Internal to
// the library. spec/50-deformable.md sections 5 to 7.

class MainReader {
 public:
  /// pre  `object` outlives the reader.   in   hierarchy  its own
  MainReader(const DeformableObject& object, std::shared_ptr<const VertexHierarchy> hierarchy)
      : object_(object),
        hierarchy_(std::move(hierarchy)),
        rings_(object),
        predictor_(object),
        coder_(*hierarchy_, object.rest.size()),
        expected_(object.rest.size()),
        coefficients_(object.basis.steps.size()) {}

  /// Everything after key, baseline and tick.
  /// out  next     the state after the packet; after an error undefined
  ///      returns  vertices with a residual
  template <class Coder>
  Result<std::uint32_t> read(Coder& coder, MainModels& models, MainHead& head, const MainState& base, MainState& next) noexcept {
    code_main_head(coder, models, object_, rings_, base, head);
    if (coder.too_wide()) return fail(Errc::malformed, "R-RNG-4");
    if (head.touched && head.triangle >= object_.triangles.size()) return fail(Errc::invalid, "R-DEF-9");
    if (head.haptic > kMaxHapticIndex || head.visual > kMaxVisualBound) return fail(Errc::invalid, "R-DEF-10");
    if (head.weight_set >= hierarchy_->parents.size()) return fail(Errc::invalid, "R-DEF-14");
    const std::int64_t tick = base.tick + head.tick_delta;
    predictor_.predict(base, tick, expected_);
    coder_.set_packet(head, rings_, object_.rings);
    coder_.fade(object_, base, tick, expected_, next);
    if (object_.layered) coder_.begin_layer(base, head.same_frame, expected_, next.displacement);
    if (head.layer == Layer::haptic) {
      keep_motion(base, next);
    } else {
      code_coefficients(coder, models, coefficients_);
      if (coder.too_wide()) return fail(Errc::malformed, "R-RNG-4");
      scale_coefficients(object_, mode_reach(head), coefficients_);
      predictor_.add_modes(coefficients_, expected_);
      predictor_.update(base, tick, next);
    }
    const std::uint32_t updates = read_vertices(coder, models, head, next);
    if (coder.too_wide()) return fail(Errc::malformed, "R-RNG-4");
    coder_.keep_off_basis(base, head.same_frame, next);
    coder_.keep_haptic_correction(head.layer, next);
    keep_head(head, base, next);
    return updates;
  }

  /// Displacement that a state predicts for a tick.   Valid until the next call.
  std::span<const Vec3i> predict(const MainState& state, std::int64_t tick) noexcept {
    predictor_.predict(state, tick, expected_);
    return expected_;
  }

 private:
  /// After a residual that is too wide, the loop continues with zeros.
  template <class Coder>
  std::uint32_t read_vertices(Coder& coder, MainModels& models, const MainHead& head, MainState& next) noexcept {
    std::uint32_t updates = 0;
    coder_.run(expected_, next.displacement,
               [&](std::uint32_t, const VertexContext& context, const auto& axes, const Vec3i&, std::int64_t) noexcept {
                 Vec3i residual{};
                 if (coder.too_wide() || !code_significance(coder, models, head.density, context, false)) return residual;
                 code_residual(coder, models, context, axes(), residual);
                 updates += is_zero(residual) ? 0u : 1u;
                 return residual;
               });
    return updates;
  }

  const DeformableObject& object_;
  std::shared_ptr<const VertexHierarchy> hierarchy_;
  Rings rings_;
  ShapePredictor predictor_;
  VertexCoder coder_;
  std::vector<Vec3i> expected_;
  std::vector<std::int32_t> coefficients_;
};

// ==== main decoder ====
// Profile main: decodes payloads into states, a function of payload and baseline. spec/50-deformable.md sections 5 to 7.
// Internal to the library; Receiver is the way in.

/// A codec of SubstreamDecoder.
class MainDecoder {
 public:
  using State = MainState;
  static constexpr RuleName kTickRule = "R-DEF-8";

  /// in   driven  what the device of the client does to an object with a body; null: no device is known
  /// pre  `scene` outlives the decoder
  MainDecoder(const Scene& scene, const DeformableObject& object, std::unique_ptr<FollowedShape> driven)
      : object_(object),
        baseline_span_(scene.baseline_span),
        reader_(object, scene.hierarchy(object)),
        next_(initial_main_state(object)),
        driven_(std::move(driven)),
        shown_(object.body ? object.rest.size() : 0) {}

  /// err  malformed R-RNG-4
  Result<PacketHead> read_head(std::span<const std::uint8_t> payload) noexcept;
  /// time O(vertices * (1 + modes)), 60 us for 714 vertices and 48 modes; no allocation.   err  malformed R-RNG-n; invalid R-DEF-9, 10
  Result<void> read_body(const MainState& base, std::int64_t tick, DecodedPacket& out) noexcept;
  void commit(const MainState&, MainState& next) noexcept { std::swap(next_, next); }
  std::uint64_t bit() const noexcept { return 8 * std::min<std::uint64_t>(coder_.position(), payload_); }

  /// Displacements shown at a tick not before the state's. Valid until the next call.
  std::span<const Vec3i> predict(const MainState& state, std::int64_t tick) noexcept;

 private:
  const DeformableObject& object_;
  std::uint8_t baseline_span_;
  MainReader reader_;
  RangeDecoder coder_{{}};
  std::uint64_t payload_ = 0;  // [bytes]
  MainModels models_ = main_start_models();
  MainHead head_;
  MainState next_;                         // pending: no state changes before the whole packet has proved valid
  std::unique_ptr<FollowedShape> driven_;  // null: no device is known
  std::vector<Vec3i> shown_;               // of a state that follows the device
};

// ==== deformable decoder ====
// The substream of one deformable object at a receiver, whatever its profile. Internal to the library; Receiver is the way in.

class DeformableDecoder {
 public:
  /// The one place that chooses by profile.   pre  object < scene.deformables.size(), and `scene` outlives the decoder
  /// in   driven  as of MainDecoder
  static std::unique_ptr<DeformableDecoder> create(const Scene& scene, std::size_t object, const DecodeLimits& limits,
                                                   std::unique_ptr<FollowedShape> driven);
  virtual ~DeformableDecoder() = default;

  /// in, err  Receiver::push
  virtual Result<DecodedPacket> decode(std::uint64_t number, std::span<const std::uint8_t> packet) noexcept = 0;
  /// Newest decoded displacement of every vertex, x 2^-position_exp m.
  virtual std::span<const std::array<std::int32_t, 3>> displacements() const noexcept = 0;
  /// Predicted displacements at a tick; a tick before the newest packet counts as that packet's. Valid until the next call.
  virtual std::span<const std::array<std::int32_t, 3>> displacements_at(std::int64_t tick) noexcept = 0;
  /// The same from the newest state held that is not later than the tick, for a client that shows the past. spec/60-client.md 6
  virtual std::span<const std::array<std::int32_t, 3>> displacements_of(std::int64_t tick) noexcept = 0;
  virtual bool holds(std::uint64_t number) const noexcept = 0;  ///< the state after the packet of this number
  virtual std::int64_t tick() const noexcept = 0;               ///< of the newest packet, 0 before the first
  virtual std::uint64_t state_hash() const noexcept = 0;
};

/// The same with the codec of a profile.
template <class Codec>
class DeformableDecoderOf final : public DeformableDecoder {
 public:
  template <class... More>
  DeformableDecoderOf(const Scene& scene, std::size_t index, const DecodeLimits& limits, typename Codec::State initial,
                      More&&... more)
      : object_(scene.deformables[index]),
        stream_(scene, limits, std::move(initial), scene, object_, std::forward<More>(more)...),
        number_(index + 1) {}

  Result<DecodedPacket> decode(std::uint64_t number, std::span<const std::uint8_t> packet) noexcept override {
    TACTUS_TRY(DecodedPacket decoded, stream_.decode(number, packet));
    decoded.substream = number_;
    return decoded;
  }
  std::span<const Vec3i> displacements() const noexcept override { return stream_.newest().displacement; }
  std::span<const Vec3i> displacements_at(std::int64_t tick) noexcept override { return predict(stream_.newest(), tick); }
  std::span<const Vec3i> displacements_of(std::int64_t tick) noexcept override { return predict(stream_.at(tick), tick); }
  bool holds(std::uint64_t number) const noexcept override { return stream_.holds(number); }
  std::int64_t tick() const noexcept override { return stream_.newest().tick; }
  std::uint64_t state_hash() const noexcept override { return hash_of_state(object_, stream_.newest()); }

 private:
  std::span<const Vec3i> predict(const typename Codec::State& state, std::int64_t tick) noexcept {
    return stream_.codec().predict(state, std::clamp(tick, state.tick, kTickLimit));
  }

  const DeformableObject& object_;
  SubstreamDecoder<Codec> stream_;
  std::size_t number_;
};

}  // namespace tactus
