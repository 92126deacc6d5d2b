// SPDX-License-Identifier: Apache-2.0
/// The client's copy of the world: decoded states, extrapolated and, if asked, smoothed. spec/60-client.md; thesis 3.2.3.1.
/// Integers only, so that every client shows the same pose and the same shape bit for bit. A Receiver keeps one up to date.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <tactus/packet/packet.h>
#include <tactus/rigid/curve.h>
#include <tactus/rigid/rigid_predictor.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/scene/scene.h>

namespace tactus {

// ==== timelines ====
// What a client that shows the past knows of each object: its updates in the order of their ticks, as far back as they may be shown. One
// pool for all objects, so that what rests costs one of them. spec/60-client.md section 7.

class Timelines {
 public:
  using Index = std::uint32_t;
  static constexpr Index kNone = ~Index{0};

  struct Update {
    std::uint64_t number = 0;  ///< of the packet that made it; 0: the initial state
    RigidState state;
    Index previous = kNone, next = kNone;  ///< of the same object
  };
  /// The updates on either side of a tick.
  struct Around {
    Index before = 0;     ///< the last that is not later; without one, the first
    Index after = kNone;  ///< the next, if one is known
  };

  /// Allocates for `objects` + 128 updates of each, 4096 at least and 32 768 at most; memory is taken by those that are used.
  explicit Timelines(std::size_t objects);
  /// How long updates are kept after a newer one of any object came [ticks]; without this as long as there is room. Of an older time the
  /// last of each object stays.
  void keep(std::int64_t ticks) noexcept { kept_ = ticks; }

  void reset(const Scene& scene) noexcept;  ///< to the initial states of its objects.   pre  as many as there are
  /// Add an update. Without room all objects forget their oldest.   time O(1) for updates in order
  void add(std::uint32_t object, std::uint64_t number, const RigidState& state) noexcept;
  Around around(std::uint32_t object, std::int64_t tick) const noexcept;  ///< time O(updates after `tick`)
  const Update& operator[](Index index) const noexcept { return updates_[index]; }
  std::size_t size(std::uint32_t object) const noexcept;  ///< time O(size)

 private:
  void trim(std::uint32_t object, std::int64_t horizon) noexcept;
  void make_room() noexcept;
  Index take() noexcept;

  std::vector<Update> updates_;      // those that were ever used
  std::vector<Index> first_, last_;  // by object
  Index free_ = kNone;               // a list by `next`
  std::int64_t kept_ = std::int64_t{1} << 40, newest_ = 0;
  std::uint32_t swept_ = 0;  // object that was looked at last
};

/// Which of the newest packets were decoded.
class HeardPackets {
 public:
  static constexpr std::uint64_t kReach = 1024;  ///< numbers

  void reset() noexcept { *this = {}; }
  void add(std::uint64_t number) noexcept;
  /// Whether all packets between two numbers were decoded, these not counted.   time O(numbers between), at most kReach
  bool all_between(std::uint64_t first, std::uint64_t last) const noexcept;

 private:
  bool has(std::uint64_t number) const noexcept {
    return newest_ - number < kReach && (bits_[word(number)] >> (number % 64) & 1u);
  }
  static std::size_t word(std::uint64_t number) noexcept { return static_cast<std::size_t>(number / 64 % (kReach / 64)); }

  std::array<std::uint64_t, kReach / 64> bits_{};
  std::uint64_t newest_ = 0;  // 0: none
};

// ==== gap interpolation ====
// The path of an object between two updates when a packet between them is missing. spec/60-client.md section 7.

/// A cubic that leaves `a` and meets `b` with their velocities; a straight line where these are 0.
/// Its error grows with the fourth power of the time between, that of dead reckoning with the second.
/// pre  a.tick <= tick <= b.tick, a.tick < b.tick, b.tick - a.tick <= max_extrapolation.   time about 0.5 us, no allocation.
RigidPose interpolate_gap(const Scene& scene, const RigidState& a, const RigidState& b, std::int64_t tick) noexcept;

// ==== replica ====

/// linear, hermite and blending are of component thesis (thesis/thesis.h).
enum class Interpolation : std::uint8_t {
  none,      ///< a new state is applied at once (NI)
  linear,    ///< over t_N, the difference to the new state fades at constant rate (WI): a straight line; thesis eqs. 3.4-3.6
  hermite,   ///< the same on a cubic that keeps the velocity at both ends; thesis eq. 3.7
  blending,  ///< the difference fades at constant rate, the old velocity in a cubic (projective velocity blending); thesis eq. 3.8
  playout,  ///< the client shows ticks in the past, by a playout delay of its choice, and interpolates over gaps that losses leave
};

/// The heuristic for t_N of component thesis: `fraction` of the mean of the last 5 inter-arrival times, clipped. An update during a running interpolation
/// ends it: the new state is applied at once.
struct ReplicaOptions {
  Interpolation interpolation = Interpolation::none;
  double fraction = 0.75;   ///< P
  double shortest = 0.005;  ///< [s]
  double longest = 0.100;   ///< [s]
};

class DeformableDecoder;
class UpdateInterpolation;
struct RigidStates;

class Replica {
 public:
  /// R-API-4: not 0 < fraction <= 1, not 0 <= shortest <= longest <= 10 s, or interpolation of component thesis in a smoothed
  /// scene.   unsupported R-API-16: such an interpolation without the component
  static Result<void> check(const ReplicaOptions& options, const Scene& scene, const ThesisComponent* thesis = nullptr) noexcept;
  /// pre  check(); scene, decoders and path outlive the replica
  /// in   shapes  one per deformable object;  device  path of this client's device, which may drive objects; null: it is not known
  Replica(const Scene& scene, const ReplicaOptions& options, std::vector<DeformableDecoder*> shapes,
          const DevicePath* device = nullptr, const ThesisComponent* thesis = nullptr);
  Replica(Replica&&) noexcept;
  ~Replica();

  /// Apply a decoded packet of the rigid objects at tick `arrival`: its own, or later when the network delayed it. An earlier
  /// arrival counts as the packet's tick, or as that of the object's last update, if that is later. With Interpolation::playout the
  /// arrival does not matter. Packets may come in any order.
  /// in  states   those after that packet
  /// time O(updates), no allocation.
  void apply(const DecodedPacket& packet, const RigidStates& states, std::int64_t arrival) noexcept;

  /// With Interpolation::playout: how far back from the newest tick poses are asked for.   in   delay  [ticks]
  void keep(std::int64_t delay) noexcept { timelines_.keep(delay + reach_); }

  /// With Interpolation::playout: this number is not that of a lost packet.
  void skip_number(std::uint64_t number) noexcept { heard_.add(number); }

  /// Pose of one object as shown at tick `now`. Before the object's newest update, the pose shown when that was applied. With
  /// Interpolation::playout `now` is the tick that is shown, not before any shown so far.
  /// pre  object < scene.objects.size().   time about 50 ns, 100 ns while interpolating or smoothing, 0.5 us over a gap; with playout and smoothing
  ///      1 us for each update that came within 2^smoothing_exp ticks of the next, at most 64 of them. No allocation.
  RigidPose pose(std::uint32_t object, std::int64_t now) const noexcept;

  /// Level of detail of an object as shown at tick `now`, in a scene with interest: its bounds are 2^lod times as wide; kOutOfInterest: it should
  /// not be shown.   pre, time  as pose()
  std::uint8_t lod(std::uint32_t object, std::int64_t now) const noexcept;

  /// Displacements of a deformable object's vertices as shown at tick `now`, V x 3, x 2^-position_exp m. Valid until the next call.
  /// pre  object < scene.deformables.size().   time O(V * modes), no allocation.
  std::span<const std::array<std::int32_t, 3>> displacements(std::size_t object, std::int64_t now) noexcept;

  std::uint64_t pose_hash(std::int64_t now) const noexcept;  ///< FNV-1a over every shown pose (conformance)

 private:
  struct Track {
    SmoothedPath path;         // from the newest state
    std::uint64_t number = 0;  // of its packet
    std::int64_t begin = 0;    // tick from which it is shown
  };
  static constexpr unsigned kMostSmoothed = 64;  // updates back
  void add_to_timelines(const DecodedPacket& packet, const RigidStates& states) noexcept;
  RigidPose path_from(std::uint32_t object, const Timelines::Update& a, std::int64_t tick) const noexcept;
  PoseOffset past_offset(std::uint32_t object, Timelines::Index update) const noexcept;
  RigidPose past_pose(std::uint32_t object, std::int64_t tick) const noexcept;

  const Scene& scene_;
  RigidPredictor predictor_;
  bool is_late_;                                  // playout
  std::int64_t reach_;                            // [ticks] longest gap to interpolate over
  std::unique_ptr<UpdateInterpolation> updates_;  // of component thesis, if asked for
  std::vector<Track> tracks_;                     // in mode none alone
  Timelines timelines_;                           // of no object without playout
  HeardPackets heard_;
  std::vector<DeformableDecoder*> shapes_;
};

}  // namespace tactus
