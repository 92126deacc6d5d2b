// SPDX-License-Identifier: Apache-2.0
/// Datagrams of a session as values, and back: syntax only. spec/70-session.md sections 2 to 6. Internal to the library.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>

#include <tactus/base/bytes.h>
#include <tactus/base/result.h>

namespace tactus {

inline constexpr std::size_t kLargestDatagram = 1200;  ///< [bytes] without its seal

enum class Direction : std::uint8_t { up, down };  ///< from a client to the server, and back

enum class Role : std::uint8_t {
  observer,     ///< only looks
  participant,  ///< touches: sends the samples of a device
};

enum class LeaveReason : std::uint8_t { bye, version, full, limits, silence, scene, protocol };

struct Join {
  Role role = Role::observer;
  std::uint64_t nonce = 0;
  std::uint64_t cookie = 0;        ///< 0: none yet
  std::uint64_t state_limit = 0;   ///< [bytes] DecodeLimits::state_bytes of the client
  std::uint64_t packet_limit = 0;  ///< [bytes]
  friend bool operator==(const Join&, const Join&) = default;
};

struct Challenge {
  std::uint64_t nonce = 0;
  std::uint64_t cookie = 0;
  friend bool operator==(const Challenge&, const Challenge&) = default;
};

/// A scene declaration to come, and all that belongs to it.
struct Epoch {
  std::uint64_t epoch = 0;
  std::uint64_t size = 0;   ///< [bytes] of the declaration
  std::uint64_t hash = 0;   ///< FNV-1a of its bytes
  std::uint64_t start = 0;  ///< [us] the server's clock at tick 0
  friend bool operator==(const Epoch&, const Epoch&) = default;
};

struct Welcome {
  std::uint64_t nonce = 0;
  std::uint16_t client = 0;
  Epoch epoch;
  std::uint64_t time = 0;  ///< [us] the server's clock when it was sent
  friend bool operator==(const Welcome&, const Welcome&) = default;
};

struct Refusal {
  std::uint64_t nonce = 0;
  LeaveReason reason = LeaveReason::bye;
  friend bool operator==(const Refusal&, const Refusal&) = default;
};

struct Leave {
  LeaveReason reason = LeaveReason::bye;
  friend bool operator==(const Leave&, const Leave&) = default;
};

// Parts of numbered datagrams. Spans point into the datagram.

struct PacketPart {
  std::uint64_t back = 0;  ///< the packet's number is so far below the datagram's
  std::span<const std::uint8_t> bytes;
};

struct FragmentPart {
  std::uint32_t index = 0, count = 0;
  std::span<const std::uint8_t> bytes;
};

struct Acknowledgement {
  static constexpr std::uint16_t kNoTiming = 65535;
  std::uint16_t newest = 0;        ///< highest number taken, modulo 2^16
  std::uint16_t held = kNoTiming;  ///< [16 us] since it came
  std::uint64_t missing = 0;       ///< bit i: number newest - 1 - i was not taken
  friend bool operator==(const Acknowledgement&, const Acknowledgement&) = default;
};

struct ClockPart {
  std::uint64_t time = 0;  ///< [us] the sender's clock when the datagram was sent
};

struct PiecePart {
  std::uint64_t offset = 0;
  std::span<const std::uint8_t> bytes;
};

struct ReadyPart {};

struct HashPart {
  std::uint8_t substream = 0;
  std::uint16_t number = 0;  ///< of the packet, modulo 2^16
  std::uint32_t hash = 0;    ///< low bits of the state hash after it
};

/// In the order of their types, 1..8.
using Part = std::variant<PacketPart, FragmentPart, Acknowledgement, ClockPart, PiecePart, ReadyPart, HashPart, Epoch>;

/// Parts one after the other. Those for later versions are skipped.
class PartReader {
 public:
  /// A datagram of kind parts, or with `single` the packet of one of kind packet.
  PartReader(std::span<const std::uint8_t> bytes, Direction direction, bool single) noexcept
      : reader_(bytes, kStart), direction_(direction), single_(single) {}

  /// The next part; nothing at the end.
  /// err  truncated, malformed R-SES-3: an element; malformed R-SES-5: order, type or direction, a packet that should be single
  Result<std::optional<Part>> next() noexcept;

 private:
  static constexpr std::size_t kStart = 3;  // of the parts in the datagram [bytes]
  Result<std::optional<Part>> read(std::uint8_t type, ByteReader part) noexcept;

  ByteReader reader_;
  Direction direction_;
  bool single_;
  std::uint8_t last_ = 0;  // type of the part before
  std::size_t parts_ = 0;
  bool only_packet_ = false;  // the first part is a packet of the datagram's own number
};

/// A numbered datagram whose parts have been read once without an error.
struct Numbered {
  std::uint16_t number = 0;  ///< modulo 2^16
  std::span<const std::uint8_t> bytes;
  bool single = false;  ///< `bytes` is one packet
  PartReader parts(Direction direction) const noexcept { return {bytes, direction, single}; }
};

using Datagram = std::variant<Join, Challenge, Welcome, Refusal, Leave, Numbered>;

/// err  invalid R-SES-2: its kind or length; truncated, malformed R-SES-3: its elements; unsupported R-SES-9: its version;
///      malformed R-SES-5: its parts
/// time O(bytes); no allocation
Result<Datagram> read_datagram(std::span<const std::uint8_t> bytes, Direction direction) noexcept;

/// Writes datagrams into a buffer of its own.
class DatagramWriter {
 public:
  /// One that is not numbered. The span is valid until the next call.   time O(1); no allocation
  std::span<const std::uint8_t> write(const Datagram& handshake) noexcept;

  /// Begin a numbered one.
  void begin(std::uint16_t number) noexcept;
  /// False, and nothing changes: there is no room.   pre  types do not fall
  bool add(const Part& part) noexcept;
  bool empty() const noexcept { return parts_ == 0; }
  /// Bytes left for a packet that is the next part.
  std::size_t room() const noexcept;
  /// Valid until the next call.   pre  a part was added
  std::span<const std::uint8_t> finish() noexcept;

 private:
  std::array<std::uint8_t, kLargestDatagram> bytes_{};
  std::size_t size_ = 0, parts_ = 0;
  std::size_t single_ = 0;  // where the bytes of the only packet of the datagram's number begin; 0: there is none
};

}  // namespace tactus
