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
#include <tactus/session/session_options.h>

namespace tactus {

inline constexpr std::size_t kLargestDatagram = 1200;  ///< [bytes] with its check
inline constexpr std::uint64_t kNumbers = 1 << 14;     ///< datagrams carry their numbers modulo this

enum class Direction : std::uint8_t { up, down };  ///< from a client to the server, and back

struct Join {
  Role role = Role::observer;
  std::uint64_t nonce = 0;
  std::uint64_t state_limit = 0;   ///< [bytes] DecodeLimits::state_bytes of the client
  std::uint64_t header_limit = 0;  ///< [bytes] DecodeLimits::header_bytes
  std::uint64_t token = 0;         ///< of the session that the client goes on with; 0: none
  std::uint8_t seat = 0;           ///< that it wants, from 1; 0: any
  bool is_known = true;            ///< its version; else there is nothing here but the nonce
  friend bool operator==(const Join&, const Join&) = default;
};

/// A scene declaration to come, and the epoch that begins with it.
struct Welcome {
  std::uint64_t nonce = 0;
  std::uint64_t serial = 0;  ///< of the epochs of this client, from 0
  std::uint64_t epoch = 0;
  std::uint16_t client = 0;
  std::uint64_t size = 0;   ///< [bytes] of the declaration
  std::uint64_t hash = 0;   ///< FNV-1a of its bytes
  std::uint64_t start = 0;  ///< [us] the server's clock at tick 0
  std::uint64_t world = 0;  ///< what is simulated; 0: not declared
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

// Parts of numbered datagrams, in the order of their types. Spans point into the datagram.

struct Acknowledgement {
  static constexpr std::uint16_t kNoTiming = 65535;
  std::uint16_t newest = 0;        ///< highest number accepted, modulo 2^16
  std::uint16_t held = kNoTiming;  ///< [16 us] since it came
  std::uint64_t missing = 0;       ///< bit i: number newest - 1 - i, above 0, was not accepted
  friend bool operator==(const Acknowledgement&, const Acknowledgement&) = default;
};

struct ClockPart {
  std::uint64_t time = 0;  ///< [us] the server's clock when the datagram was sent
};

struct ButtonsPart {
  std::uint32_t tick = 0;  ///< of the device, since when they are
  std::uint32_t mask = 0;  ///< bit i: button i is down
  friend bool operator==(const ButtonsPart&, const ButtonsPart&) = default;
};

/// How the device's ticks follow those of the server. spec/65-signal.md section 4
struct TickMappingPart {
  std::int64_t from = 0;    ///< tick of the server, 0 to 2^32 - 1
  std::int64_t offset = 0;  ///< from then on the device's tick is the server's less this; within +-2^33
};

struct PiecePart {
  std::uint64_t index = 0;
  std::span<const std::uint8_t> bytes;
};

/// How far the client is. It also keeps the session alive, and is ack-eliciting.
struct StatePart {
  std::uint8_t live = 0;  ///< 1: it holds the declaration, and wants packets
};

/// What a participant plays.
struct SeatPart {
  std::uint8_t seat = 0;  ///< from 1; 0: none
};

struct HashPart {
  std::uint8_t substream = 0;
  std::uint16_t number = 0;  ///< of the packet, modulo 2^16
  std::uint32_t hash = 0;    ///< low bits of the state hash after it
};

/// What a live client shows and lacks.
struct ReportPart {
  std::uint64_t delay = 0;  ///< [ms] of its playout
  /// kKey: packets wait for one that does not come; kView: there is a view.
  std::uint8_t flags = 0;
  std::array<std::int32_t, 3> view{};  ///< where the client looks from, world frame, x 2^-kViewExponent m
  static constexpr std::uint8_t kKey = 1, kView = 2;
  static constexpr int kViewExponent = 8;
};

/// On what packets down build from this datagram on.
struct BaselinesPart {
  std::uint8_t policy = 0;  ///< 0: the packet before; 1: one that was acknowledged
};

struct FragmentPart {
  std::uint64_t back = 0;  ///< the packet's number is so far below the datagram's
  std::uint64_t substream = 0, index = 0, count = 0;
  std::span<const std::uint8_t> bytes;
};

struct PacketPart {
  std::uint64_t back = 0;  ///< the packet's number is so far below the datagram's
  std::span<const std::uint8_t> bytes;
};

/// In the order of their types, 1..8; but TickMappingPart, ReportPart, SeatPart and BaselinesPart have those of ButtonsPart, PiecePart, StatePart
/// and HashPart, in the other direction.
using Part = std::variant<Acknowledgement, ClockPart, ButtonsPart, PiecePart, StatePart, HashPart, FragmentPart, PacketPart,
                          TickMappingPart, ReportPart, SeatPart, BaselinesPart>;

/// Parts one after the other. Those for later versions are skipped.
class PartReader {
 public:
  /// A datagram of kind parts, or with `single` the packet of one of kind packet.
  PartReader(std::span<const std::uint8_t> bytes, Direction direction, bool single) noexcept
      : reader_(bytes, kStart), direction_(direction), single_(single) {}

  /// The next part; nothing at the end.
  /// err  truncated, malformed R-SES-3: an element; malformed R-SES-5: order, type or direction, a packet that should be single,
  ///      one beside a fragment
  Result<std::optional<Part>> next() noexcept;

 private:
  static constexpr std::size_t kStart = 2;  // of the parts in the datagram [bytes]
  Result<std::optional<Part>> read(std::uint8_t type, ByteReader part) noexcept;

  ByteReader reader_;
  Direction direction_;
  bool single_;
  std::uint8_t last_ = 0;  // type of the part before
  std::size_t parts_ = 0;
  bool only_packet_ = false;  // the first part is a packet of the datagram's own number
  bool fragment_ = false;     // there was one: neither packets nor another may follow
};

inline constexpr std::size_t kNumberedOverhead = 6;  ///< [bytes] head and check of a numbered datagram

/// A numbered datagram whose parts have been read once without an error.
struct Numbered {
  std::uint16_t number = 0;  ///< modulo 2^14
  std::span<const std::uint8_t> bytes;
  bool single = false;  ///< `bytes` is one packet
  PartReader parts(Direction direction) const noexcept { return {bytes, direction, single}; }
};

using Datagram = std::variant<Join, Welcome, Refusal, Leave, Numbered>;

/// The CRC-32 at the end of a datagram holds for this epoch and direction. Joins, welcomes and refusals have epoch 0.
/// time O(bytes), about 2 ns per byte
bool is_of_epoch(std::span<const std::uint8_t> datagram, std::uint64_t epoch, Direction direction) noexcept;

/// A join, welcome or refusal: its epoch is 0.
bool is_before_epochs(std::span<const std::uint8_t> datagram) noexcept;

/// pre  is_of_epoch()
/// err  checksum R-SES-1: its length; invalid R-SES-2: its kind; truncated, malformed R-SES-3: its elements; unsupported R-SES-9: its
///      version; malformed R-SES-5: its parts
/// time O(bytes); no allocation
Result<Datagram> read_datagram(std::span<const std::uint8_t> datagram, Direction direction) noexcept;

/// Writes the datagrams of one direction into a buffer of its own.
class DatagramWriter {
 public:
  explicit DatagramWriter(Direction direction) noexcept : direction_(direction) {}

  /// One that is not numbered. The span is valid until the next call.   time O(1); no allocation
  std::span<const std::uint8_t> write(const Datagram& message, std::uint64_t epoch = 0) noexcept;

  /// Begin a numbered one.
  void begin(std::uint64_t number) noexcept;
  /// False, and nothing changes: there is no room.   pre  types do not fall
  bool add(const Part& part) noexcept;
  bool empty() const noexcept { return parts_ == 0; }
  /// Bytes left for the data of one more part.
  std::size_t room() const noexcept;
  /// Valid until the next call.   pre  a part was added
  std::span<const std::uint8_t> finish(std::uint64_t epoch) noexcept;

 private:
  std::span<const std::uint8_t> with_check(std::size_t size, std::uint64_t epoch) noexcept;

  std::array<std::uint8_t, kLargestDatagram> bytes_{};
  Direction direction_;
  std::size_t size_ = 0, parts_ = 0;
  bool fragment_ = false;   // the last part is one
  std::size_t single_ = 0;  // where the bytes of the only packet of the datagram's number begin; 0: there is none
};

}  // namespace tactus
