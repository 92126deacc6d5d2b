// SPDX-License-Identifier: Apache-2.0
/// Encoder of deformable objects: profile main, and the interface to both profiles. Internal to the library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/deformable/displacement.h>
#include <tactus/deformable/encoder_fit.h>
#include <tactus/deformable/main_state.h>
#include <tactus/deformable/main_syntax.h>
#include <tactus/deformable/vertex_coder.h>
#include <tactus/packet/held_list.h>
#include <tactus/packet/packet.h>
#include <tactus/packet/sender_policy.h>
#include <tactus/packet/substream_encoder.h>
#include <tactus/scene/scene.h>
#include <tactus/scene/scene_objects.h>

namespace tactus {

// ==== main encoder ====
// Profile main: codes true displacements of one object into payloads, a function of truth and baseline. Internal to the library;
// Sender is the way in.
//
// After every frame a decoder's prediction obeys, for every vertex,
//   |u^ - u| <= v, and <= h = p |f_s| / k_c inside the area of interest,
// A bound below the grid's rounding (0.87 units) means the nearest grid point. After the haptic packet of a layered object this
// holds for the vertices inside the area of interest.

/// A codec of SubstreamEncoder.
class MainEncoder {
 public:
  using State = MainState;

  /// in   driven  what the device of the client does to an object with a body; null: no device is known
  /// pre  `scene` outlives the encoder
  MainEncoder(const Scene& scene, const DeformableObject& object, const DeformableOptions& options,
              std::unique_ptr<FollowedShape> driven);

  /// The truth of one frame, on the grid.   pre  both live until the last encode() of the frame
  void read(std::span<const Vec3i> truth, const SurfaceTouch* touch) noexcept {
    truth_ = truth;
    touch_ = touch;
  }
  void set_bound_scale(double factor) noexcept { bound_scale_ = factor; }
  /// time O(vertices * (1 + modes)), no allocation
  Result<Payload> encode(const EncodeRequest<MainState>& request, std::span<std::uint8_t> out) noexcept;
  void commit(const MainState&, MainState& next) noexcept { std::swap(next_, next); }

 private:
  struct CodedVertex {
    VertexContext context;
    AxisContexts axes;
    Vec3i residual{};
  };

  MainHead head_for(const EncodeRequest<MainState>& request) noexcept;
  bool is_within_bounds() const noexcept;
  Following choose_following(const EncodeRequest<MainState>& request) noexcept;
  void predict_shown(const EncodeRequest<MainState>& request) noexcept;
  bool bounds_hold(const EncodeRequest<MainState>& request) noexcept;
  void choose_coefficients(const MainHead& head) noexcept;
  void move_modes(const MainHead& head) noexcept;
  std::uint32_t choose_residuals() noexcept;
  Payload write_vertices(MainHead& head, const MainState& base, std::span<std::uint8_t> out) noexcept;
  Payload write_shortest(MainHead& head, const MainState& base, std::span<std::uint8_t> out) noexcept;
  std::size_t write(MainHead head, const MainState& base, std::span<std::uint8_t> out) noexcept;

  const DeformableObject& object_;
  const DeformableThresholds thresholds_;
  const double visual_fraction_, haptic_fraction_;
  double bound_scale_ = 1;
  double unit_;  // [m] of the grid
  std::uint8_t baseline_span_;
  std::span<const Vec3i> truth_;
  const SurfaceTouch* touch_ = nullptr;
  std::shared_ptr<const VertexHierarchy> hierarchy_;
  Rings rings_;
  ShapePredictor predictor_;
  VertexCoder coder_;
  ModeProjection projection_;
  AreaFit area_fit_;
  MainState next_;               // pending until commit()
  std::vector<Vec3i> expected_;  // temporal prediction
  std::vector<Vec3i> error_;
  std::vector<std::int32_t> coefficients_, scaled_;  // in steps; in grid units
  std::vector<float> projected_;
  std::vector<CodedVertex> coded_;
  std::unique_ptr<FollowedShape> driven_;  // null: no device is known
  std::uint32_t trigger_[2]{};             // outside and inside the area of interest: errors that call for a packet, grid units
  std::uint32_t limit_[2]{};               // errors that a packet corrects: fractions of the same
};

// ==== deformable encoder ====
// The substream of one deformable object at a sender, whatever its profile. Internal to the library; Sender is the way in.

class FollowedShape;

/// The truth of one deformable object on the grid, for all who code it.
class ShapeTruth {
 public:
  /// pre  `scene` and `held` outlive this.   allocates
  ShapeTruth(const Scene& scene, std::uint32_t object, HeldList& held);

  /// Take the truth of a tick. A shape that breaks a rule is the last one that broke none, and such a touch does not count: both are noted.
  /// in   truth  null: there is no news.   pre  as many displacements as the object has, or none
  /// time 1 ns per component, no allocation
  void read(std::int64_t tick, const DeformableTruth* truth) noexcept;

  bool is_new() const noexcept { return is_new_; }  ///< the last read() had a shape
  std::span<const Vec3i> shape() const noexcept { return shape_; }
  const SurfaceTouch* touch() const noexcept { return touch_ ? &*touch_ : nullptr; }
  std::size_t components() const noexcept { return 3 * shape_.size(); }

 private:
  HeldList& held_;
  std::uint32_t object_;
  std::size_t triangles_;
  std::uint8_t position_exp_;
  bool is_new_ = false;
  std::vector<Vec3i> shape_, next_;
  std::optional<SurfaceTouch> touch_;
};

/// Largest packet of an object of the scene, without the number of its substream [bytes].
std::size_t max_packet(const Scene& scene, const DeformableObject& object) noexcept;

class DeformableEncoder {
 public:
  /// R-API-4: an option is negative, NaN or too large.
  static Result<void> check(const DeformableOptions& options) noexcept;
  /// The one place that chooses by profile.   in   driven  as of MainEncoder.   pre  check(), object < scene.deformables.size(), and `scene` outlives the encoder
  static std::unique_ptr<DeformableEncoder> create(const Scene& scene, std::size_t object, const DeformableOptions& options,
                                                   const SenderPolicy& policy, std::unique_ptr<FollowedShape> driven);
  virtual ~DeformableEncoder() = default;

  /// Take the truth of one frame; changes nothing else.   pre  it is new, and lives until the last encode() of the frame
  virtual void read(const ShapeTruth& truth) noexcept = 0;
  /// Code one packet of the frame. A layered object takes its haptic layer first, then the visual one; others take Layer::all.
  /// Returns a packet without bytes if none is needed.
  /// in   number  as in SubstreamEncoder::encode
  virtual Packet encode(std::int64_t tick, Layer layer, std::optional<std::uint64_t> number) noexcept = 0;
  virtual bool is_layered() const noexcept = 0;
  virtual bool is_owed(std::int64_t tick) const noexcept = 0;  ///< as SubstreamEncoder::is_owed
  virtual void set_link(const LinkState& link) noexcept = 0;   ///< nothing without Baseline::acknowledged, or with layers
  virtual void set_bound_scale(double factor) noexcept = 0;    ///< of all thresholds.   pre  factor >= 1
  virtual void request_key() noexcept = 0;
  virtual void forget_last() noexcept = 0;
  virtual void acknowledge(std::uint64_t number) noexcept = 0;
  virtual std::uint64_t state_hash() const noexcept = 0;
};

/// The same with the codec of a profile.
template <class Codec>
class DeformableEncoderOf final : public DeformableEncoder {
 public:
  template <class... More>
  DeformableEncoderOf(const Scene& scene, std::size_t index, const DeformableOptions& options, const SenderPolicy& policy,
                      std::size_t largest, bool layered, typename Codec::State initial, More&&... more)
      : object_(scene.deformables[index]),
        layered_(layered),
        stream_(scene, layered ? chained(policy) : policy, index + 1, largest, layered ? 2 : 1, initial, scene, object_, options,
                std::forward<More>(more)...) {}

  void read(const ShapeTruth& truth) noexcept override { stream_.codec().read(truth.shape(), truth.touch()); }
  Packet encode(std::int64_t tick, Layer layer, std::optional<std::uint64_t> number) noexcept override {
    return stream_.encode(tick, layer, number).value_or(Packet{});
  }
  bool is_layered() const noexcept override { return layered_; }
  bool is_owed(std::int64_t tick) const noexcept override { return stream_.is_owed(tick); }
  /// Where nothing is lost an acknowledgement is late at most.
  void set_link(const LinkState& link) noexcept override {
    stream_.set_ack_timeout(link.loss >= kSomeLoss ? link.ack_timeout : 0);
  }
  void set_bound_scale(double factor) noexcept override { stream_.codec().set_bound_scale(factor); }
  void request_key() noexcept override { stream_.request_key(); }
  void forget_last() noexcept override { stream_.forget_last(); }
  void acknowledge(std::uint64_t number) noexcept override { stream_.acknowledge(number); }
  std::uint64_t state_hash() const noexcept override { return hash_of_state(object_, stream_.newest()); }

 private:
  static constexpr double kSomeLoss = 0.003;  // fraction of packets

  /// A packet of one layer takes the vertices of the other from its baseline, so it must build on the newest packet.
  static SenderPolicy chained(SenderPolicy policy) noexcept {
    policy.baseline = Baseline::previous;
    return policy;
  }

  const DeformableObject& object_;
  bool layered_;
  SubstreamEncoder<Codec> stream_;
};

}  // namespace tactus
