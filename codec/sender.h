// SPDX-License-Identifier: Apache-2.0
/// The server's side: true states in, packets out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <tactus/base/result.h>
#include <tactus/deformable/trigger.h>
#include <tactus/packet/packet.h>
#include <tactus/packet/sender_policy.h>
#include <tactus/rigid/contact.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/rigid/trigger.h>
#include <tactus/scene/scene.h>

namespace tactus {

struct SenderOptions {
  RigidTriggers triggers{};
  DeformableOptions deformable{};
  SenderPolicy policy{};
};

/// What truly is at one tick. All spans need to live until encode() returns.
struct Truth {
  std::span<const RigidSample> objects{};  ///< one per rigid object of the scene; those of static objects are not looked at
  std::span<const Contact> contacts{};     ///< of rigid objects: any number, from any clients
  std::span<const DeformableTruth> deformables{};  ///< one per deformable object; empty: none has a new shape
};

/// Decides at every tick what must be sent, and codes it.
///
/// Bounds. After every tick a receiver that got all packets shows, without interpolation, for every object, contact and vertex given,
///   |x^ - x| <= visual_position,  angle(q^, q) <= visual_rotation,  haptic_ratio(f, f^) <= 1,  |u^ - u| <= v, and <= h where it is felt;
/// where a bound is finer than the grid, the nearest place on the grid. Deformable objects of profile thesis only aim at theirs.
///
/// Loss. With Baseline::previous each packet builds on the one before it in its substream: a receiver that misses one refuses those
/// that follow (R-PKT-4) until a key packet, after key_interval or request_key(). With Baseline::acknowledged it builds on the newest
/// state that acknowledge() named. A key packet of a layered object forgets its shape outside the area of interest until the visual
/// packet arrives; where nobody joins or seeks, key_interval 0 saves that.
///
/// Threads: one at a time. The scene is shared. No allocation and no exception after create().
class Sender {
 public:
  /// err  invalid_argument R-API-4: an option of what the scene has is negative, NaN, too large or finer than the grid;
  ///      limit_exceeded R-API-11 memory
  static Result<Sender> create(SharedScene scene, const SenderOptions& options = {});

  /// Look at one tick and decide.
  /// in   tick  strictly increasing, below 2^32 - 1
  /// out  at most one packet per substream, two of a layered object; what is felt goes first. Valid until the next call: bind the Result
  ///      to a name before you walk over it
  /// time < 1 us per rigid object; O(V * (1 + modes)) per new shape, 100 us for 714 vertices and 48 modes.
  /// err  invalid_argument R-API-1, 2, 3 a sample, displacement or force is not finite or out of range; R-API-5 wrong count, order of
  ///      ticks, contact, triangle, force or stiffness; R-API-6 an object moved along an axis that it does not have; R-API-7 it is
  ///      further from where it is expected than an update can tell. Nothing has changed after an error.
  Result<std::span<const Packet>> encode(std::int64_t tick, const Truth& truth) noexcept;

  /// A receiver refuses what it gets (Advice::request_key): the next packet of every substream is a key packet, also where every bound
  /// holds. One of the rigid objects names all that have left the initial state; while none has, there is nothing to send.
  void request_key() noexcept;

  /// The receiver has decoded this packet.   in  substream, sequence  as in Packet.   Unknown and old ones change nothing.
  void acknowledge(std::size_t substream, std::uint16_t sequence) noexcept;

  /// The packet of this substream that was made last will not be decoded (it is dropped, or known to be lost): the next one builds on the
  /// state before it, or on the initial one if the scene's baseline_span does not reach so far. Only once after each packet.
  void forget_last(std::size_t substream) noexcept;

  const SharedScene& scene() const noexcept;
  /// Of a substream: equals the receiver's after the same packets.   pre  the substream exists
  std::uint64_t state_hash(std::size_t substream) const noexcept;

  Sender(Sender&&) noexcept;
  Sender& operator=(Sender&&) noexcept;
  ~Sender();

 private:
  struct Impl;
  explicit Sender(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus
