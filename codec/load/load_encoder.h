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
#include <tactus/packet/sender_policy.h>
#include <tactus/packet/substream_encoder.h>
#include <tactus/scene/scene_objects.h>

namespace tactus {

/// A codec of SubstreamEncoder.
class LoadEncoder {
 public:
  using State = LoadState;

  /// R-API-4: a threshold is not positive or not finite.
  static Result<void> check(const LoadThresholds& thresholds) noexcept;
  /// pre  check(), the scene has loads and outlives the encoder
  LoadEncoder(const Scene& scene, const LoadThresholds& thresholds, Baseline baseline);

  /// Take the loads of one tick; changes nothing else.   in  loads  one per rigid object; those of static ones are ignored
  /// err  invalid_argument R-API-1, 2 a force is not finite or out of range; R-API-5 wrong count of objects or users
  Result<void> read(std::int64_t tick, std::span<const ObjectLoad> loads) noexcept;
  /// pre  read() took the request's tick.   time O(vectors), about 5 ns for one; no allocation
  Result<Payload> encode(const EncodeRequest<LoadState>& request, std::span<std::uint8_t> out) noexcept;
  void commit(const LoadState& base, LoadState& next) noexcept;
  void acknowledge(std::uint64_t number) noexcept { acknowledged_ = acknowledged_ || number == number_; }
  void set_link(const LinkState& link) noexcept;  ///< nothing without Baseline::acknowledged
  void set_widening(double factor) noexcept { widening_ = factor; }

 private:
  bool within(const Vec3i& held, const Vec3i& truth, double share) const noexcept;
  bool is_out(std::size_t object, const LoadState& state, double share) const noexcept;
  void collect(const EncodeRequest<LoadState>& request) noexcept;
  std::uint8_t quantise(std::size_t object, const LoadState& base) noexcept;

  const Scene& scene_;
  LoadThresholds thresholds_;
  bool is_acknowledged_;  // Baseline::acknowledged
  double floor_ = 0;      // in grid steps
  double widening_ = 1;
  std::vector<Vec3i> truth_, wanted_;  // of this tick; as decoders will hold it
  std::vector<std::size_t> pending_;   // objects, by their place in Scene::moving()
  std::vector<LoadStep> steps_;        // of one object
  std::int64_t tick_ = 0, sent_ = 0;   // now, and of the newest packet
  std::int64_t answer_ = 0;            // [ticks] after which a packet that is not acknowledged is made anew; 0: never
  std::uint64_t number_ = 0;           // of the newest packet
  bool acknowledged_ = true;           // it is
};

}  // namespace tactus
