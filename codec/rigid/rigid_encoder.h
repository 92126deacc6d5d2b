// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <tactus/base/result.h>
#include <tactus/rigid/contact.h>
#include <tactus/rigid/rigid.h>
#include <tactus/rigid/trigger.h>
#include <tactus/scene/scene_syntax.h>

namespace tactus {

/// What one call of RigidEncoder::encode produced.
struct EncodedPacket {
  std::span<const std::uint8_t> bytes;  ///< empty: every trigger is silent, nothing to send. Valid until the next call
  Reason reason = Reason::request;      ///< strongest reason among the updates (haptic > visual > heartbeat > request)
  std::uint32_t updates = 0;            ///< objects in the packet
  bool key = false;                     ///< builds on the initial state: a place to seek to
};

struct RigidEncoderOptions {
  RigidTriggers triggers;
  double key_interval = 5.0;  ///< [s] after this long the next packet builds on the initial state (a place to seek to); 0: never,
                              ///< but after 8 s of silence, when receivers may soon have forgotten what there was
  std::uint16_t first_sequence = 1;  ///< a sender that begins anew towards the same receivers takes another number, at random
};

/// Server side: true states in, at most one packet per tick out.
///
/// After every tick the decoder's prediction obeys, for every object and contact given,
///   |x^ - x| <= visual_position,  angle(q^, q) <= visual_rotation,  haptic_ratio(f, f^) <= 1.
/// where a bound that is finer than the grid (a small force_floor, a stiff contact) means: the nearest place on the grid.
/// The encoder holds the decoder's state (closed loop) and picks for every update the coarsest grid level that keeps the quantised
/// state well inside these bounds.
///
/// Each packet builds on the one before it, whatever the header's baseline_span: the bounds hold for a receiver that gets all of
/// them. One that lost a packet holds what it had until the next key packet: after key_interval, or after request_key().
class RigidEncoder {
 public:
  /// err  R-STR-n: the header is not valid, with the class that parse_header gives; invalid_argument R-API-4: a threshold is negative,
  ///      NaN or finer than the grid.
  static Result<RigidEncoder> create(StreamHeader header, const RigidEncoderOptions& options = {});

  /// Look at one tick and decide.
  /// in   tick      strictly increasing
  ///      samples   one per object of the header, same order; those of static objects are not looked at
  ///      contacts  any number, from any clients
  /// time O(objects), < 1 us per object; no allocation, no exception.
  /// err  invalid_argument R-API-1..3 a sample is not finite or out of range; R-API-5 wrong count, tick order or contact;
  ///      R-API-6 an object moved along an axis that the header says it cannot; R-API-7 it is further from where it is expected than
  ///      an update can tell. State is unchanged after any error.
  Result<EncodedPacket> encode(std::int64_t tick, std::span<const RigidSample> samples,
                               std::span<const Contact> contacts) noexcept;

  /// A packet was lost, and the receiver refuses all that build on it (R-PKT-4): the next call of encode() sends a key packet, also
  /// where every trigger is silent. It names all objects that have left the initial state; while none has, there is nothing to send.
  void request_key() noexcept;

  const StreamHeader& header() const noexcept;
  std::uint64_t state_hash() const noexcept;  ///< equals the decoder's after the same packets

  RigidEncoder(RigidEncoder&&) noexcept;
  RigidEncoder& operator=(RigidEncoder&&) noexcept;
  ~RigidEncoder();

 private:
  struct Impl;
  explicit RigidEncoder(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace tactus
