// SPDX-License-Identifier: Apache-2.0
/// From a trace to a stream and back: the header that carries a trace, a stream played tick by tick, what the stream cost, and how
/// far what a client shows and feels is from the truth.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/client/replica.h>
#include <tactus/file/stream_file.h>
#include <tactus/metrics/deformable_link.h>
#include <tactus/packet/substream.h>
#include <tactus/rigid/rigid_decoder.h>
#include <tactus/rigid/trigger.h>
#include <tactus/trace/frame.h>

namespace tactus {

/// The stream that carries a trace: its objects in order, at rest in the poses of `first`, and its meshes; extrapolation for 2 s.
/// err  invalid_argument R-API-1..3 a pose or mesh does not fit the grid, R-API-5 wrong count, R-STR-n, R-MES-n the header would not
///      be valid; those of a basis
Result<StreamHeader> stream_header(const TraceInfo& info, const TraceFrame& first, const DeformableCoding& coding = {});

/// Plays a stream file into a replica, as if every packet arrived in the tick that sent it.
class StreamPlayer {
 public:
  /// pre  `file` outlives the player.   err  as StreamFileReader::open and Replica::create
  static Result<StreamPlayer> open(std::span<const std::uint8_t> file, const ReplicaOptions& options = {});

  struct Played {
    std::size_t part = 0;          ///< 0: the rigid objects; i + 1: mesh i
    DecodedPacket packet;          ///< of the rigid objects
    DecodedDeformablePacket mesh;  ///< of a mesh
    std::size_t bytes = 0;         ///< of the packet with the number of its part
    std::size_t offset = 0;        ///< of the packet in the file

    std::int64_t tick() const noexcept { return part == 0 ? packet.tick : mesh.tick; }
    std::uint16_t sequence() const noexcept { return part == 0 ? packet.sequence : mesh.sequence; }
    bool key() const noexcept { return part == 0 ? packet.key : mesh.key; }
  };
  /// Apply the next packet that is due at `tick`; nothing when none is.
  /// err  as StreamFileReader::next, split_part, RigidDecoder::decode and DeformableDecoder::decode, places counted from the start of the
  ///      file; invalid R-FIL-7: the file and the packet name different ticks.
  Result<std::optional<Played>> play(std::int64_t tick) noexcept;
  /// Tick of the next packet; nothing at the end.   err  as play()
  Result<std::optional<std::int64_t>> next_tick() noexcept;

  Pose pose(std::uint32_t object, std::int64_t tick) const noexcept;
  /// What the client shows of a mesh, on the grid. Valid until the next call.
  std::span<const DeformableDecoder::Displacement> displacements(std::size_t mesh, std::int64_t tick) noexcept {
    return meshes_[mesh].displacements_at(tick);
  }
  const StreamHeader& header() const noexcept { return reader_.header(); }
  std::uint64_t header_bytes() const noexcept { return reader_.header_bytes(); }
  bool complete() const noexcept { return reader_.complete(); }  ///< known at the end

 private:
  StreamPlayer(std::span<const std::uint8_t> file, StreamFileReader reader, RigidDecoder decoder, Replica replica) noexcept;
  Result<Played> decode(const PartPacket& packet) noexcept;

  std::span<const std::uint8_t> file_;
  StreamFileReader reader_;
  RigidDecoder decoder_;
  Replica replica_;
  std::vector<DeformableDecoder> meshes_;
  std::optional<FilePacket> waiting_;
};

/// What was sent.
struct RateMetrics {
  std::array<std::uint64_t, 4> packets{};  ///< by strongest reason; index: Reason
  std::uint64_t updates = 0;
  std::uint64_t bytes = 0;  ///< of packets, without any header below them
  std::uint64_t keys = 0;

  void add(Reason reason, std::uint64_t update_count, std::uint64_t byte_count, bool key) noexcept;
  std::uint64_t all_packets() const noexcept { return packets[0] + packets[1] + packets[2] + packets[3]; }
};

/// Strongest reason among the updates of a packet.
Reason strongest_reason(const DecodedPacket& packet) noexcept;

/// One kind of error over time. Samples are added tick by tick; a tick counts as over when any of its samples is.
class ErrorSeries {
 public:
  void add(double error, bool over) noexcept;
  /// pre  `tick` is larger than the last
  void end_tick(std::int64_t tick) noexcept;

  std::uint64_t ticks() const noexcept { return ticks_; }  ///< that had a sample
  std::uint64_t ticks_over() const noexcept { return ticks_over_; }
  std::uint64_t longest_run() const noexcept {
    return longest_run_;
  }  ///< [ticks] from first to last over, none between that was not
  double rms() const noexcept;
  double max() const noexcept { return max_; }

 private:
  std::uint64_t samples_ = 0, ticks_ = 0, ticks_over_ = 0, longest_run_ = 0;
  TickSpan run_;
  double square_sum_ = 0, max_ = 0;
  bool sampled_ = false, over_ = false;  // in this tick
};

/// Holds a replica against the truth. Objects that cannot move are left out, and so are forces where nobody touches.
/// The force error is that of the contact itself: the force at the shown pose against the force at the true pose (contact_force).
class ErrorMetrics {
 public:
  ErrorMetrics(const TraceInfo& info, const RigidTriggers& bounds);

  /// in   shown  one pose per object
  /// time O(objects + users), no allocation.
  void add(const TraceFrame& truth, std::span<const Pose> shown) noexcept;
  /// Also hold the force that the client rendered against the server's (closed loop only).
  void add_rendered(const TraceFrame& truth) noexcept;

  const RigidTriggers& bounds() const noexcept { return bounds_; }
  const ErrorSeries& position() const noexcept { return position_; }    ///< [m] against visual_position
  const ErrorSeries& rotation() const noexcept { return rotation_; }    ///< [rad] against visual_rotation
  const ErrorSeries& force() const noexcept { return force_; }          ///< [N] against the haptic rule
  const ErrorSeries& perceived() const noexcept { return perceived_; }  ///< the same errors against perceptual_fraction
  const ErrorSeries& rendered() const noexcept { return rendered_; }    ///< [N] as felt, against perceptual_fraction
  double worst_haptic_ratio() const noexcept { return worst_ratio_; }   ///< largest haptic_ratio; <= 1: the rule held

 private:
  bool breaks_rule(const Pose& truth, const Pose& shown, const Vec3& force, const Vec3& estimate) noexcept;
  bool is_perceptible(double force, double error) const noexcept;

  RigidTriggers bounds_;
  std::vector<std::uint32_t> moving_;
  ErrorSeries position_, rotation_, force_, perceived_, rendered_;
  double worst_ratio_ = 0;
};

}  // namespace tactus
