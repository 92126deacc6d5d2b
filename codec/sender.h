// SPDX-License-Identifier: Apache-2.0
/// The server's side: true states in, packets out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <tactus/base/result.h>
#include <tactus/deformable/displacement.h>
#include <tactus/load/load_state.h>
#include <tactus/packet/held_part.h>
#include <tactus/packet/packet.h>
#include <tactus/packet/sender_policy.h>
#include <tactus/rigid/rigid_state.h>
#include <tactus/rigid/trigger.h>
#include <tactus/scene/scene.h>

namespace tactus {

class DevicePath;
struct KnownDevice;

struct SenderOptions {
  RigidTriggers triggers{};
  DeformableOptions deformable{};
  LoadThresholds load{};
  SenderPolicy policy{};
};

/// True state of the scene at one tick. All spans must stay valid until encode() returns.
struct Truth {
  std::span<const RigidSample> objects{};          ///< one per rigid object of the scene; entries of static objects are ignored
  std::span<const Contact> contacts{};             ///< of rigid objects: any number, from any clients
  std::span<const DeformableTruth> deformables{};  ///< one per deformable object; empty: none has a new shape
  std::span<const ObjectLoad> loads{};  ///< one per rigid object, if the scene has loads; those of static ones are ignored
  /// Indices of the objects whose sample is not that of the tick given before, as the caller knows; without it all are compared, which
  /// takes 10 ns each. An object that moves and is not named is not sent.
  std::optional<std::span<const std::uint32_t>> moved{};
};

/// What all senders of one scene share: the truth of a tick and what follows from it. A server with many clients reads it once, and what its
/// senders find out with the same states they find out once. No byte of any packet depends on it.
///
/// Threads: one at a time, with all its senders.
class SharedTruth {
 public:
  /// in   options  those of all its senders, which may differ in the policy.   err  as Sender::create
  static Result<std::shared_ptr<SharedTruth>> create(SharedScene scene, const SenderOptions& options = {});

  /// Take the truth of a tick, before its senders encode it. The spans must stay valid until they have.
  /// time 10 ns per object that can move, 0.2 us for one that has moved, 3 ns per vertex of a new shape; no allocation
  /// err  as Sender::encode
  Result<void> read(std::int64_t tick, const Truth& truth) noexcept;
  std::span<const HeldPart> held() const noexcept;  ///< as Sender::held()

  SharedTruth(SharedTruth&&) = delete;
  SharedTruth& operator=(SharedTruth&&) = delete;
  ~SharedTruth();

 private:
  friend class Sender;
  struct Impl;
  explicit SharedTruth(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

/// Decides at every tick which states must be sent, and codes them.
///
/// Bounds. After every tick, a receiver that got all packets and does not interpolate satisfies, for every
/// object, contact of normal force f and vertex given,
///   |x^ - x| <= visual_position,  angle(q^, q) <= visual_rotation,  haptic_ratio(f, f^) <= 1,
///   |u^ - u| <= v, and <= h inside the area of interest,
///   |f^ - f| <= p max(|f|, floor) for every vector of a load.
/// A bound finer than the grid means the nearest grid point. Profile thesis only aims at its bounds.
///
/// Loss. With Baseline::previous each packet builds on the one before it in its substream. A receiver that misses a packet
/// refuses the following ones (R-PKT-4) until a key packet, sent after key_interval or request_key(). With Baseline::acknowledged
/// a packet builds on the newest state that acknowledge() named, so that every one that arrives can be decoded, and set_link() has states
/// sent again. The bounds above still hold only for what arrived: a client that shows the past (Interpolation::playout) interpolates over the
/// gaps. Baseline::repaired leaves loss to the transport. With both a packet that goes out anyway also names the rigid objects that are
/// over half of a bound: where each packet has the headers of a datagram, these are most of the bits.
/// A key packet of a layered object drops the shape outside the area of interest until the visual packet arrives. If no client joins or
/// seeks, key_interval 0 avoids that.
///
/// Held. One bad object does not stop the others: what breaks a rule is coded as it was last, at rest, until it breaks none, and the bounds
/// above hold for that. held() says what and since when.
///
/// Threads: one at a time. The scene is shared. No allocation and no exception after create().
class Sender {
 public:
  /// err  invalid_argument R-API-4: an option that this scene uses is negative, NaN, too large or finer than the grid;
  ///      limit_exceeded R-API-11 memory
  static Result<Sender> create(SharedScene scene, const SenderOptions& options = {});
  /// The same with a truth that others share: read() it before each encode().   pre  it is of the same scene and options
  static Result<Sender> create(SharedScene scene, const SenderOptions& options, std::shared_ptr<SharedTruth> truth);
  /// The same where the device of the one receiver is known, which may drive objects (SceneBuilder::driven()): those that it pushes or holds
  /// are sent when they leave the way that the receiver works out from its own device. Else the scene's driven objects are coded as any other.
  /// in   truth   null: of its own
  ///      device  where the device is at each tick that is encoded, with all packets up to then; null: it is not known
  static Result<Sender> create(SharedScene scene, const SenderOptions& options, std::shared_ptr<SharedTruth> truth,
                               std::shared_ptr<const DevicePath> device);

  /// Evaluate one tick and code the packets that it needs.
  /// in   tick    strictly increasing, below 2^32 - 1
  ///      number  of the packets of this tick, above that of any packet before and below 2^62 - 1, as a transport numbers what it sends; a
  ///              second packet of an object has number + 1. A receiver with Interpolation::playout is told of numbers without a packet of
  ///              rigid objects: Receiver::skip_number(). Without: each substream counts on, from 1, as files do.
  /// out  at most one packet per substream, two for a layered object, its haptic layer first. Valid until the next call: bind the
  ///      Result to a name before iterating over it
  /// time < 1 us per rigid object that moves, while contacts are few (each object looks at all of them); those that rest 10 ns;
  ///      O(V * (1 + modes)) per new shape, 100 us for 714 vertices and 48 modes.
  /// A jump of more than 2^31 steps of the position grid, 512 m by default, takes two updates, in two ticks.
  /// err  invalid_argument R-API-5 wrong count or order of ticks or numbers: what the caller as a whole did wrong. An error leaves the sender
  ///      unchanged.
  Result<std::span<const Packet>> encode(std::int64_t tick, const Truth& truth,
                                         std::optional<std::uint64_t> number = {}) noexcept;

  /// Parts of the truth of the last encode() that are held: those that are not finite (R-API-1), off the grid (R-API-2), no rotation
  /// (R-API-3) or off their axes (R-API-6), and contacts and touches that are none (R-API-15), 16 contacts at most. Mostly none.
  /// out  valid until the next encode().   time 1 ns
  std::span<const HeldPart> held() const noexcept;

  /// Call when a receiver refuses packets (Advice::request_key). The next packet of every substream is then a key packet, sent
  /// even if every bound holds. The rigid key packet names the objects that have left their initial state; if none has, it is
  /// not sent.
  void request_key() noexcept;
  void request_key(std::size_t substream) noexcept;  ///< the same for one substream

  /// Report that the receiver has decoded a packet. Report all of them, in any order: the newest is the next baseline, and objects
  /// that others named are not sent again. Numbers of no packet, or of one long ago, are ignored.
  /// in  substream, number  as in Packet
  void acknowledge(std::size_t substream, std::uint64_t number) noexcept;

  /// Report what the link to the receiver and back does. With Baseline::acknowledged the newest state of an object is sent again, made
  /// anew, while no acknowledgement names a packet that held it; of a deformable object without layers, where packets get lost.
  void set_link(const LinkState& link) noexcept;

  /// Multiply all bounds but the heartbeat, from the next tick on: less to send where the link does not carry what they ask for.
  /// in   factor  1 to 64; it is limited to these. 1: the bounds as given
  void set_bound_scale(double factor) noexcept;

  /// In a scene with interest: where its client looks from, from the next tick on, so that what is far is sent with wider bounds or not at all
  /// (SceneBuilder::interest()). Before the first call all rigid objects are sent in full; where no viewpoint is known, none.
  /// in   viewpoints  [m] at most two: its device, and its eyes or whatever stands for them. Others are ignored.   time 10 ns
  void set_viewpoints(std::span<const Vec3> viewpoints) noexcept;

  /// Report that the newest packet of this substream is dropped and was never sent. The next one builds on the state before it, and has its
  /// number where packets are counted. At most once per packet. One that was sent and is lost is not acknowledged, which says enough.
  void forget_last(std::size_t substream) noexcept;

  const SharedScene& scene() const noexcept;
  /// State of a rigid object as a receiver of all packets has it, by its index in the scene.
  const RigidState& object(std::uint32_t object) const noexcept;
  /// Hash of a substream's state; equals the receiver's after the same packets.   pre  the substream exists
  std::uint64_t state_hash(std::size_t substream) const noexcept;

  Sender(Sender&&) noexcept;
  Sender& operator=(Sender&&) noexcept;
  ~Sender();

 private:
  struct Impl;
  static Result<Sender> create_with(SharedScene scene, const SenderOptions& options, std::shared_ptr<SharedTruth> truth,
                                    KnownDevice device);
  explicit Sender(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus
