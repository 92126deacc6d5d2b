// SPDX-License-Identifier: Apache-2.0
/// Packets and why they were sent. spec/25-packet.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <tactus/scene/scene_objects.h>

namespace tactus {

// ==== reason ====

/// Why an object's state was sent. Values are wire values (spec/40-rigid.md table 1).
enum class Reason : std::uint8_t {
  request = 0,    ///< no trigger: a key packet or a stream without data reduction
  heartbeat = 1,  ///< time-out since the last update
  visual = 2,     ///< position or rotation error over the visual threshold (visual dead reckoning)
  haptic = 3,     ///< force error over the haptic threshold (haptic dead reckoning, thesis eq. 3.1)
};

// ==== packet ====
// Packets as a sender gives them and as a receiver reports them. spec/40-rigid.md section 2, spec/25-packet.md section 1.

/// One object in a packet of the rigid objects.
struct RigidUpdate {
  std::uint32_t object = 0;  ///< index into Scene::objects
  Reason reason = Reason::request;
  std::uint8_t level = 0;  ///< grid level: residuals were multiples of 2^level grid units
};

/// A packet to send.
struct Packet {
  std::span<const std::uint8_t> bytes;  ///< with the number of its substream; valid until the sender's next call of encode()
  std::size_t substream = 0;            ///< 0: the rigid objects; i + 1: deformable object i; the next: the loads
  std::uint64_t number = 0;         ///< above that of every packet of its substream before; the packet itself does not name it
  bool key = false;                 ///< builds on the initial state: a tick to seek to
  Layer layer = Layer::all;         ///< deformable objects: which vertices it codes
  Reason reason = Reason::request;  ///< rigid objects: strongest among the updates (haptic > visual > heartbeat > request)
  std::uint32_t updates = 0;        ///< objects, or vertices with a residual of their own
};

/// A packet that was received and decoded.
struct DecodedPacket {
  std::size_t substream = 0;
  std::uint64_t number = 0;  ///< as pushed: the order of sending
  bool key = false;
  std::uint64_t baseline = 0;  ///< number of the packet that it builds on; 0: a key packet
  std::int64_t tick = 0;
  Layer layer = Layer::all;                ///< deformable objects, profile main; not coded in profile thesis
  std::span<const RigidUpdate> updates{};  ///< rigid objects; valid until the receiver's next push()
  std::uint32_t loads = 0;                 ///< loads: objects named
  std::uint32_t vertices = 0;              ///< deformable objects: vertices with a residual of their own
  std::uint32_t final_range = 0;           ///< range decoder's state after the last symbol (conformance)
  std::uint32_t final_code = 0;
};

}  // namespace tactus
