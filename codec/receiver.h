// SPDX-License-Identifier: Apache-2.0
/// The client's side: packets in, a replica out.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <tactus/base/geometry.h>
#include <tactus/base/result.h>
#include <tactus/client/replica.h>
#include <tactus/load/load_state.h>
#include <tactus/packet/packet.h>
#include <tactus/scene/scene.h>

namespace tactus {

class DevicePath;
struct KnownDevice;

struct ReceiverOptions {
  ReplicaOptions replica{};
  DecodeLimits limits{};
};

/// Keeps the newest `baseline_span` states of each substream and nothing else.
///
/// Packets may be lost, repeated, or come in any order, after an outage of any length. A packet is decoded from exactly the baseline that
/// it was coded against, or it is refused. spec/25-packet.md 4 and 5.
/// The receiver cannot detect damaged bytes (the transport must carry a check value) or another sender: what a restarted one sends goes to a
/// new receiver.
///
/// Threads: one at a time. The scene is shared. No allocation and no exception after create().
class Receiver {
 public:
  /// err  invalid_argument R-API-4: a replica option; limit_exceeded R-STR-14, R-STR-18 the scene is beyond the limits, R-API-11 memory;
  ///      unsupported R-API-16: an interpolation of component thesis, which neither the limits nor the scene have
  static Result<Receiver> create(SharedScene scene, const ReceiverOptions& options = {});
  /// The same where the device of this client is known, as its server knows it: what it drives is shown where it moves it, packet or none.
  /// in   device  its path; null: it is not known
  static Result<Receiver> create(SharedScene scene, const ReceiverOptions& options, std::shared_ptr<const DevicePath> device);

  /// Decode a packet and apply it to the replica. An error leaves the receiver unchanged.
  /// in   number, packet  as Packet::number and Packet::bytes: the transport tells both
  ///      now     [ticks] of this client when it shows it; without: the packet's own
  /// out  what to acknowledge: substream and number
  /// time < 2 us for one rigid update; 60 us for 714 vertices and 48 modes; no allocation.
  /// err  advice() says how to react. truncated, malformed, invalid: R-PKT, R-RIG, R-DEF, R-RNG; limit_exceeded R-PKT-1;
  ///      state R-PKT-5: the packet was decoded before, or comes later than all that are held; R-PKT-4: its baseline is not held, as
  ///      an earlier packet is lost or late; invalid_argument R-API-5: a number of 0, or of 2^62 and more
  Result<DecodedPacket> push(std::uint64_t number, std::span<const std::uint8_t> packet,
                             std::optional<std::int64_t> now = {}) noexcept;

  /// The packet is decoded, and its state may be a baseline: it came before.   in  number, packet  as push()
  bool holds(std::uint64_t number, std::span<const std::uint8_t> packet) const noexcept;

  /// This number arrived, and no packet of rigid objects has it: the replica need not interpolate over it. For transports whose numbers are
  /// not those of packets of rigid objects alone.
  void skip_number(std::uint64_t number) noexcept;

  /// Pose of a rigid object as shown at `tick`: what Replica::pose() has in integers.
  /// in   object  its index in the scene: Scene::find()     pre  it is one of the scene
  /// out  [m], world frame   time about 50 ns, no allocation; more on Replica::pose()
  Pose pose(std::uint32_t object, std::int64_t tick) const noexcept;
  /// Shape of a deformable object as shown at `tick`: what Replica::displacements() has in integers.
  /// in   object  as pose(), among the deformable objects
  /// out  V x 3 [m] from the rest shape, world frame, x y z of vertex 0 first, as DeformableTruth. Valid until the next call.
  /// time O(V * modes), no allocation.
  std::span<const float> displacements(std::size_t object, std::int64_t tick) noexcept;

  /// The same in integers, which are equal at every client, and levels of detail.
  Replica& replica() noexcept;

  const SharedScene& scene() const noexcept;
  /// State of a rigid object after a packet of them.   pre  push() has just returned it
  const RigidState& object_after(const DecodedPacket& packet, std::uint32_t object) const noexcept;
  /// Newest state of a rigid object, by its index in the scene.
  const RigidState& object(std::uint32_t object) const noexcept;
  /// Newest decoded displacements of a deformable object, V x 3, x 2^-position_exp m.   pre  object < scene.deformables.size()
  std::span<const std::array<std::int32_t, 3>> decoded_displacements(std::size_t object) const noexcept;
  /// Vectors of a rigid object's load (kExternal, kHold, kPushes ..) at a tick that is shown, x 2^-force_exp N: of the newest state held
  /// that is not later. Empty: the scene has no loads, or the object cannot move. Valid until the next push().   time O(log objects)
  std::span<const GridForce> load(std::uint32_t object, std::int64_t tick) const noexcept;
  std::int64_t tick(std::size_t substream) const noexcept;         ///< tick of the newest packet, 0 before the first
  std::uint64_t state_hash(std::size_t substream) const noexcept;  ///< pre  the substream exists

  Receiver(Receiver&&) noexcept;
  Receiver& operator=(Receiver&&) noexcept;
  ~Receiver();

 private:
  struct Impl;
  static Result<Receiver> create_with(SharedScene scene, const ReceiverOptions& options, KnownDevice device);
  explicit Receiver(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus
