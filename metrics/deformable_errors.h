// SPDX-License-Identifier: Apache-2.0
/// Error of a client's view of a deformable object: every vertex, every frame.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <tactus/deformable/displacement.h>
#include <tactus/trace/frame.h>

namespace tactus {

/// Distances between true and shown vertices [m].
struct VertexErrors {
  std::uint64_t vertices = 0;    ///< evaluated, over all frames
  std::uint64_t violations = 0;  ///< those beyond their bound
  double square_sum = 0;         ///< [m^2]
  double max = 0;                ///< [m]

  double mse() const noexcept { return vertices == 0 ? 0 : square_sum / static_cast<double>(vertices); }  ///< [m^2]
};

/// Bounds are those of Sender: v everywhere (thesis eq. 3.10), min(v, h) inside the area of interest (eqs. 3.11, 3.12), and
/// nothing below the grid's rounding.
class DeformableErrors {
 public:
  /// in   rings         m: size of the area of interest
  ///      position_exp  of the stream's grid
  /// pre  the mesh passed check()
  DeformableErrors(const TriMesh& rest, const DeformableThresholds& bounds, std::uint8_t rings, unsigned position_exp);
  DeformableErrors(DeformableErrors&&) noexcept;
  DeformableErrors& operator=(DeformableErrors&&) noexcept;
  ~DeformableErrors();

  /// One frame.   in  truth  V x 3 [m];  shown  as Replica::displacements, or V x 3 [m] as a trace of a replica has it
  /// time O(V), no allocation.
  void add(std::span<const float> truth, std::span<const std::array<std::int32_t, 3>> shown,
           const std::optional<SurfaceTouch>& touch) noexcept;
  void add(std::span<const float> truth, std::span<const float> shown, const std::optional<SurfaceTouch>& touch) noexcept;

  const DeformableThresholds& bounds() const noexcept { return bounds_; }
  std::uint8_t rings() const noexcept { return rings_; }
  std::uint64_t frames() const noexcept { return frames_; }
  const VertexErrors& all() const noexcept { return all_; }
  const VertexErrors& area() const noexcept { return area_; }   ///< inside the area of interest, in frames with touch
  double worst_ratio() const noexcept { return worst_ratio_; }  ///< largest ratio of error to bound; <= 1: all bounds held
  double mean_haptic() const noexcept;                          ///< [m] mean of h over the frames with touch, 0 without

 private:
  struct Area;
  void begin(const std::optional<SurfaceTouch>& touch) noexcept;
  void add(std::size_t vertex, const Vec3& error) noexcept;

  DeformableThresholds bounds_;
  std::uint8_t rings_;
  unsigned position_exp_;
  double rounding_;  // [m] largest distance of a vertex from its nearest grid point
  std::unique_ptr<Area> finder_;
  std::uint64_t frames_ = 0, touched_ = 0;
  VertexErrors all_, area_;
  double worst_ratio_ = 0, haptic_sum_ = 0;
};

}  // namespace tactus
