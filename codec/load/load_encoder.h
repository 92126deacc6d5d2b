// SPDX-License-Identifier: Apache-2.0
/// Codes loads under a deadband of their own: a function of truth and baseline. Internal to the library; Sender is the way in.
///
/// After every tick a decoder that got every packet holds, for every vector f of every object,
///   |f^ - f| <= p max(|f|, floor),                      LoadThresholds (thesis eq. 2.8)
/// or the nearest grid point if that is finer. A packet names each object that has left its bound, and each whose baseline is off by
/// more than half of it; vectors are rounded to the coarsest level that keeps a quarter of the bound.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <tactus/load/load_syntax.h>
#include <tactus/packet/held_list.h>
#include <tactus/packet/sender_policy.h>
#include <tactus/packet/substream_encoder.h>
#include <tactus/scene/scene_objects.h>

namespace tactus {

/// The loads of a tick on the grid, for all who code them.
class LoadTruth {
 public:
  /// pre  the scene has loads; it and `held` outlive this.   allocates
  LoadTruth(const Scene& scene, HeldList& held);

  /// Take the loads of one tick. Those of an object that break a rule are those that it had last: they are noted.
  /// pre  fits().   time about 5 ns per vector, no allocation
  void read(std::int64_t tick, std::span<const ObjectLoad> loads) noexcept;
  /// One per rigid object, and of those that can move one push per user.
  bool fits(std::span<const ObjectLoad> loads) const noexcept;
  const std::vector<Vec3i>& vectors() const noexcept { return vectors_; }  ///< as in LoadState

 private:
  const Scene& scene_;
  HeldList& held_;
  std::vector<Vec3i> vectors_, next_;  // next_: of one object
};

/// A codec of SubstreamEncoder.
class LoadEncoder {
 public:
  using State = LoadState;

  /// R-API-4: a threshold is not positive or not finite.
  static Result<void> check(const LoadThresholds& thresholds) noexcept;
  /// pre  check(), the scene has loads; it and `truth` outlive the encoder
  LoadEncoder(const Scene& scene, const LoadThresholds& thresholds, Baseline baseline, const LoadTruth& truth);

  /// pre  the truth is that of the request's tick.   time O(vectors), about 5 ns for one; no allocation
  Result<Payload> encode(const EncodeRequest<LoadState>& request, std::span<std::uint8_t> out) noexcept;
  void commit(const LoadState& base, LoadState& next) noexcept;
  void acknowledge(std::uint64_t number) noexcept { acknowledged_ = acknowledged_ || number == number_; }
  void set_link(const LinkState& link) noexcept;  ///< nothing without Baseline::acknowledged
  void set_bound_scale(double factor) noexcept { bound_scale_ = factor; }

 private:
  bool within(const Vec3i& held, const Vec3i& truth, double fraction) const noexcept;
  bool is_out(std::size_t object, const LoadState& state, double fraction) const noexcept;
  void collect(const EncodeRequest<LoadState>& request) noexcept;
  std::uint8_t quantise(std::size_t object, const LoadState& base) noexcept;

  const Scene& scene_;
  LoadThresholds thresholds_;
  bool is_acknowledged_;  // Baseline::acknowledged
  double floor_ = 0;      // in grid steps
  double bound_scale_ = 1;
  const std::vector<Vec3i>& truth_;   // of this tick
  std::vector<Vec3i> wanted_;         // as decoders will hold it
  std::vector<std::size_t> pending_;  // objects, by their index in Scene::moving()
  std::vector<LoadStep> steps_;       // of one object
  std::int64_t sent_ = 0;             // tick of the newest packet
  std::int64_t ack_timeout_ = 0;      // [ticks] after which a packet that is not acknowledged is made anew; 0: never
  std::uint64_t number_ = 0;          // of the newest packet
  bool acknowledged_ = true;          // it is
};

}  // namespace tactus
