// SPDX-License-Identifier: Apache-2.0
/// The client's copy of the world: decoded states, extrapolated and, if asked, smoothed. spec/50-client.md; thesis 3.2.3.1.
/// Integers only, so that every client shows the same pose bit for bit.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/rigid/rigid.h>
#include <tactus/rigid/rigid_decoder.h>
#include <tactus/scene/scene_syntax.h>

namespace tactus {

enum class Interpolation : std::uint8_t {
  none,    ///< a new state is applied at once (NI)
  linear,  ///< straight line and SLERP towards the predicted state, over t_N (WI); thesis eqs. 3.4-3.6
};

/// The heuristic for t_N: `share` of the mean of the last 5 inter-arrival times, clipped. An update during a running interpolation
/// ends it: the new state is applied at once.
struct ReplicaOptions {
  Interpolation interpolation = Interpolation::none;
  double share = 0.75;      ///< P
  double shortest = 0.005;  ///< [s]
  double longest = 0.100;   ///< [s]
};

class Replica {
 public:
  /// err  R-STR-n, R-MES-n: the header is not valid, with the class that parse_header gives; invalid_argument R-API-4: not
  ///      0 < share <= 1, or not 0 <= shortest <= longest <= 10 s.
  static Result<Replica> create(const StreamHeader& header, const ReplicaOptions& options = {});

  /// Take over a decoded packet at tick `arrival`: its own, or later when the network delayed it. An earlier one counts as the
  /// packet's, or as that of the object's last update, if that is later.
  /// in  objects   the decoder's objects after that packet
  /// time O(updates), no allocation.
  void apply(const DecodedPacket& packet, std::span<const RigidState> objects, std::int64_t arrival) noexcept;

  /// Pose of one object as shown at tick `now`; before the object's newest update it is the pose shown when that was applied.
  /// pre  object < header.objects.size().   time O(1), about 50 ns (100 ns while interpolating), no allocation.
  RigidPose pose(std::uint32_t object, std::int64_t now) const noexcept;

  std::uint64_t pose_hash(std::int64_t now) const noexcept;  ///< FNV-1a over every shown pose (conformance)

 private:
  static constexpr std::size_t kArrivals = 5;  // M
  struct Track {
    RigidState state;                    // target: the newest state
    RigidPose from;                      // shown when the interpolation began
    RigidPose to;                        // predicted for its end
    std::int64_t begin = 0, end = 0;     // [begin, end); empty: none is running
    std::array<std::int32_t, 3> axis{};  // of the turn from `from` to `to`, x 2^-30
    std::uint32_t half_turn = 0;         // half its angle, 2^32 to the full circle
    std::int64_t last_arrival = -1;
    std::array<std::int32_t, kArrivals> gaps{};
    std::uint8_t gap_count = 0, gap_next = 0;
  };
  std::int64_t interval(const Track& track) const noexcept;
  void begin_interpolation(Track& track, const RigidPose& shown) const noexcept;

  StreamHeader header_;
  Interpolation interpolation_ = Interpolation::none;
  std::uint32_t share_ = 0;  // x 2^-16
  std::int64_t shortest_ = 0, longest_ = 0;
  std::vector<Track> tracks_;
};

}  // namespace tactus
