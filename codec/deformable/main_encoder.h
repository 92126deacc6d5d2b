// SPDX-License-Identifier: Apache-2.0
/// Profile main: codes true displacements of one object into payloads, a function of truth and baseline. Internal to the library;
/// Sender is the way in.
///
/// After every frame a decoder's prediction obeys, for every vertex,
///   |u^ - u| <= v, and <= h = p |f_s| / k_c inside the area of interest,
/// A bound below the grid's rounding (0.87 units) means the nearest grid point. After the haptic packet of a layered object this
/// holds for the vertices inside the area of interest.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <tactus/deformable/area_fit.h>
#include <tactus/deformable/followed_shape.h>
#include <tactus/deformable/main_syntax.h>
#include <tactus/deformable/mode_projection.h>
#include <tactus/deformable/trigger.h>
#include <tactus/deformable/vertex_coder.h>
#include <tactus/packet/substream_encoder.h>

namespace tactus {

/// A codec of SubstreamEncoder.
class MainEncoder {
 public:
  using State = MainState;

  /// pre  `scene` outlives the encoder
  MainEncoder(const Scene& scene, const DeformableObject& object, const DeformableOptions& options);

  /// The truth of one frame, on the grid.   pre  both live until the last encode() of the frame
  void read(std::span<const Vec3i> truth, const SurfaceTouch* touch) noexcept {
    truth_ = truth;
    touch_ = touch;
  }
  void set_widening(double factor) noexcept { widening_ = factor; }
  void know(std::unique_ptr<FollowedShape> shape) noexcept { driven_ = std::move(shape); }  ///< pre  the object has a body
  /// time O(vertices * (1 + modes)), no allocation
  Result<Payload> encode(const EncodeRequest<MainState>& request, std::span<std::uint8_t> out) noexcept;
  void commit(const MainState&, MainState& next) noexcept { std::swap(next_, next); }

 private:
  struct CodedVertex {
    VertexContext context;
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
  const double visual_share_, haptic_share_;
  double widening_ = 1;
  double unit_;  // [m] of the grid
  std::uint8_t baseline_span_;
  std::span<const Vec3i> truth_;
  const SurfaceTouch* touch_ = nullptr;
  VertexHierarchy hierarchy_;
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
  std::uint32_t limit_[2]{};               // errors that a packet corrects: shares of the same
};

}  // namespace tactus
