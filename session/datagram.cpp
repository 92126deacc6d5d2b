// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/datagram.h>

#include <algorithm>

#include <tactus/base/bytes.h>
#include <tactus/base/rule.h>

namespace tactus {
namespace {

// Forms: low bits of the head.
constexpr std::uint16_t kHandshake = 0, kParts = 1, kPacket = 2;
// Kinds of handshakes.
constexpr std::uint16_t kJoin = 0, kWelcome = 1, kRefusal = 2, kLeave = 3, kFirstUnknownKind = 4;
// Types of parts.
constexpr std::uint8_t
    kAcknowledgement = 1,
    kClock = 2, kButtons = 3, kTickMapping = 3, kPiece = 4, kReport = 4, kState = 5, kSeat = 5, kHash = 6, kBaselines = 6,
    kFragment = 7,
    kFirstUnknown = 9;  // up 3 buttons, 4 report, 5 state, 6 hash; down 3 tick mapping, 4 piece, 5 seat, 6 baselines; 8: packet

constexpr std::uint32_t kMagic = 0x53544354;  // "TCTS"
constexpr std::uint8_t kVersion = 1;
constexpr std::size_t kHeadSize = 2, kCheckSize = 4;
constexpr std::uint64_t kEndOfTime = std::uint64_t{1} << 53;  // [us] of any clock
constexpr std::int64_t kEndOfTicks = std::int64_t{1} << 32, kFarthest = std::int64_t{1} << 33;
constexpr std::size_t kLeastJoin = 80;      // [bytes]: answers are shorter
constexpr std::uint8_t kFirstSkipped = 64;  // part types for later or private use
constexpr LeaveReason kLastReason = LeaveReason::protocol;

bool kind_comes(std::uint16_t kind, Direction direction) noexcept {
  return kind == kLeave || (kind < kFirstUnknownKind && (kind == kJoin) == (direction == Direction::up));
}
bool part_comes(std::uint8_t type, Direction direction) noexcept { return type != kClock || direction == Direction::down; }

bool is_tick_mapping(const TickMappingPart& mapping) noexcept {
  return mapping.from < kEndOfTicks && mapping.offset >= -kFarthest && mapping.offset <= kFarthest;
}

/// CRC-32 of epoch, direction and body.
std::uint32_t check_of(std::span<const std::uint8_t> body, std::uint64_t epoch, Direction direction) noexcept {
  std::array<std::uint8_t, 9> front{};
  for (std::size_t i = 0; i < 8; ++i) front[i] = static_cast<std::uint8_t>(epoch >> (8 * i));
  front[8] = static_cast<std::uint8_t>(direction);
  return crc32(body, crc32(front));
}

/// Syntax of elements, and that nothing follows.
Result<void> finished(const ByteReader& reader) noexcept {
  if (reader.overrun()) return fail(Errc::truncated, "R-SES-3", reader.bit_offset());
  if (reader.overlong() || reader.remaining() > 0) return fail(Errc::malformed, "R-SES-3", reader.bit_offset());
  return {};
}

template <class T>
Result<Datagram> handshake(const ByteReader& reader, T message) noexcept {
  TACTUS_CHECK(finished(reader));
  return Datagram(std::move(message));
}

Result<Datagram> read_join(ByteReader& r) noexcept {
  const std::uint32_t magic = r.u32();
  const std::uint8_t version = r.u8(), role = r.u8();
  Join message;
  message.is_known = version == kVersion;
  message.nonce = r.u64();
  if (r.ok() && (magic != kMagic || (message.is_known && role > static_cast<std::uint8_t>(Role::participant))))
    return fail(Errc::unsupported, "R-SES-9", 8 * kHeadSize);
  const bool is_short = r.bit_offset() / 8 + r.remaining() < kLeastJoin - kCheckSize;
  if (r.ok() && is_short) return fail(Errc::truncated, "R-SES-3", r.bit_offset());
  if (r.ok() && !message.is_known) return Datagram(message);
  message.role = static_cast<Role>(role);
  message.token = r.u64();
  message.seat = r.u8();
  message.state_limit = r.varint();
  message.header_limit = r.varint();
  const std::uint64_t padding = r.bit_offset();
  const auto zeros = r.bytes(r.remaining());
  if (std::ranges::any_of(zeros, [](std::uint8_t byte) { return byte != 0; })) return fail(Errc::malformed, "R-SES-3", padding);
  return handshake(r, message);
}

Result<Datagram> read_welcome(ByteReader& r) noexcept {
  Welcome message;
  message.nonce = r.u64();
  message.serial = r.varint();
  message.epoch = r.u64();
  message.client = r.u16();
  message.size = r.varint();
  message.hash = r.u64();
  message.start = r.varint();
  message.world = r.u64();
  if (r.ok() && message.start >= kEndOfTime) return fail(Errc::malformed, "R-SES-3", r.bit_offset());
  return handshake(r, message);
}

Result<LeaveReason> read_reason(ByteReader& r) noexcept {
  const std::uint8_t reason = r.u8();
  if (reason > static_cast<std::uint8_t>(kLastReason)) return fail(Errc::malformed, "R-SES-3", r.bit_offset() - 8);
  return static_cast<LeaveReason>(reason);
}

Result<Datagram> read_numbered(ByteReader& r, std::uint16_t number, bool single, Direction direction) noexcept {
  Numbered out;
  out.number = number;
  out.bytes = r.bytes(r.remaining());
  out.single = single;
  PartReader parts = out.parts(direction);
  for (;;) {
    TACTUS_TRY(const auto part, parts.next());
    if (!part) return Datagram(out);
  }
}

/// Little-endian integers and varints into a span; fails once there is no room.
class Put {
 public:
  Put(std::span<std::uint8_t> to, std::size_t at) noexcept : to_(to), at_(at) {}

  Put& integer(std::uint64_t value, unsigned bytes) noexcept {
    for (unsigned i = 0; i < bytes; ++i) byte(static_cast<std::uint8_t>(value >> (8 * i)));
    return *this;
  }
  Put& varint(std::uint64_t value) noexcept {
    for (; value >= 0x80; value >>= 7) byte(static_cast<std::uint8_t>(value | 0x80));
    byte(static_cast<std::uint8_t>(value));
    return *this;
  }
  Put& bytes(std::span<const std::uint8_t> data) noexcept {
    if (data.size() > to_.size() - std::min(at_, to_.size())) at_ = to_.size() + 1;
    else std::copy(data.begin(), data.end(), to_.begin() + static_cast<std::ptrdiff_t>(at_)), at_ += data.size();
    return *this;
  }
  bool fits() const noexcept { return at_ <= to_.size(); }
  std::size_t at() const noexcept { return at_; }

 private:
  void byte(std::uint8_t value) noexcept {
    if (at_ < to_.size()) to_[at_] = value;
    at_ = std::min(at_, to_.size()) + 1;
  }
  std::span<std::uint8_t> to_;
  std::size_t at_;
};

constexpr std::size_t varint_size(std::uint64_t value) noexcept { return value < 0x80 ? 1 : 1 + varint_size(value >> 7); }

constexpr std::uint64_t head_of(std::uint16_t kind) noexcept { return kHandshake + 4u * kind; }

void put(Put& to, const Join& j) noexcept {
  to.integer(head_of(kJoin), 2).integer(kMagic, 4).integer(kVersion, 1).integer(static_cast<std::uint64_t>(j.role), 1);
  to.integer(j.nonce, 8).integer(j.token, 8).integer(j.seat, 1).varint(j.state_limit).varint(j.header_limit);
  while (to.at() < kLeastJoin - kCheckSize) to.integer(0, 1);
}
void put(Put& to, const Welcome& w) noexcept {
  to.integer(head_of(kWelcome), 2).integer(w.nonce, 8).varint(w.serial).integer(w.epoch, 8).integer(w.client, 2);
  to.varint(w.size).integer(w.hash, 8).varint(w.start).integer(w.world, 8);
}
void put(Put& to, const Refusal& r) noexcept {
  to.integer(head_of(kRefusal), 2).integer(r.nonce, 8).integer(static_cast<std::uint64_t>(r.reason), 1);
}
void put(Put& to, const Leave& l) noexcept { to.integer(head_of(kLeave), 2).integer(static_cast<std::uint64_t>(l.reason), 1); }
void put(Put&, const Numbered&) noexcept {}

std::size_t size_of(const Acknowledgement& a) noexcept { return 4 + varint_size(a.missing); }
std::size_t size_of(const ClockPart& c) noexcept { return varint_size(c.time); }
std::size_t size_of(const ButtonsPart&) noexcept { return 8; }
std::size_t size_of(const TickMappingPart& p) noexcept {
  return varint_size(static_cast<std::uint64_t>(p.from)) + varint_size(zigzag(p.offset));
}
std::size_t size_of(const PiecePart& p) noexcept { return varint_size(p.index) + p.bytes.size(); }
std::size_t size_of(const StatePart&) noexcept { return 1; }
std::size_t size_of(const ReportPart& r) noexcept { return varint_size(r.delay) + ((r.flags & ReportPart::kView) != 0 ? 13 : 1); }
std::size_t size_of(const BaselinesPart&) noexcept { return 1; }
std::size_t size_of(const SeatPart&) noexcept { return 1; }
std::size_t size_of(const HashPart&) noexcept { return 7; }
std::size_t size_of(const FragmentPart& f) noexcept {
  return varint_size(f.back) + varint_size(f.substream) + varint_size(f.index) + varint_size(f.count) + f.bytes.size();
}
std::size_t size_of(const PacketPart& p) noexcept { return varint_size(p.back) + p.bytes.size(); }

void put(Put& to, const Acknowledgement& a) noexcept { to.integer(a.newest, 2).integer(a.held, 2).varint(a.missing); }
void put(Put& to, const ClockPart& c) noexcept { to.varint(c.time); }
void put(Put& to, const ButtonsPart& b) noexcept { to.integer(b.tick, 4).integer(b.mask, 4); }
void put(Put& to, const TickMappingPart& p) noexcept { to.varint(static_cast<std::uint64_t>(p.from)).varint(zigzag(p.offset)); }
void put(Put& to, const PiecePart& p) noexcept { to.varint(p.index).bytes(p.bytes); }
void put(Put& to, const StatePart& s) noexcept { to.integer(s.live, 1); }
void put(Put& to, const ReportPart& r) noexcept {
  to.varint(r.delay).integer(r.flags, 1);
  if ((r.flags & ReportPart::kView) == 0) return;
  for (const std::int32_t c : r.view) to.integer(static_cast<std::uint32_t>(c), 4);
}
void put(Put& to, const BaselinesPart& b) noexcept { to.integer(b.policy, 1); }
void put(Put& to, const SeatPart& s) noexcept { to.integer(s.seat, 1); }
void put(Put& to, const HashPart& h) noexcept { to.integer(h.substream, 1).integer(h.number, 2).integer(h.hash, 4); }
void put(Put& to, const FragmentPart& f) noexcept {
  to.varint(f.back).varint(f.substream).varint(f.index).varint(f.count).bytes(f.bytes);
}
void put(Put& to, const PacketPart& p) noexcept { to.varint(p.back).bytes(p.bytes); }

/// Of a part on the wire.
std::uint8_t type_of(const Part& part) noexcept {
  if (std::holds_alternative<TickMappingPart>(part)) return kTickMapping;
  if (std::holds_alternative<ReportPart>(part)) return kReport;
  if (std::holds_alternative<BaselinesPart>(part)) return kBaselines;
  return std::holds_alternative<SeatPart>(part) ? kSeat : static_cast<std::uint8_t>(part.index() + 1);
}

/// The elements of a part; the reader says whether they were all there.
Part read_part(std::uint8_t type, Direction direction, ByteReader& r) noexcept {
  if (type == kTickMapping && direction == Direction::down) {
    const auto from = static_cast<std::int64_t>(std::min<std::uint64_t>(r.varint(), kEndOfTicks));
    return TickMappingPart{from, unzigzag(r.varint())};
  }
  if (type == kReport && direction == Direction::up) {
    ReportPart report;
    report.delay = r.varint();
    report.flags = r.u8();
    if ((report.flags & ReportPart::kView) != 0) report.view = {r.i32(), r.i32(), r.i32()};
    return report;
  }
  if (type == kBaselines && direction == Direction::down) return BaselinesPart{r.u8()};
  if (type == kSeat && direction == Direction::down) return SeatPart{r.u8()};
  switch (type) {
    case kAcknowledgement: {
      Acknowledgement a;
      a.newest = r.u16();
      a.held = r.u16();
      a.missing = r.varint();
      return a;
    }
    case kClock:
      return ClockPart{r.varint()};
    case kButtons: {
      ButtonsPart b;
      b.tick = r.u32();
      b.mask = r.u32();
      return b;
    }
    case kPiece: {
      const std::uint64_t index = r.varint();
      return PiecePart{index, r.bytes(r.remaining())};
    }
    case kState:
      return StatePart{r.u8()};
    case kHash: {
      HashPart h;
      h.substream = r.u8();
      h.number = r.u16();
      h.hash = r.u32();
      return h;
    }
    case kFragment: {
      FragmentPart f;
      f.back = r.varint();
      f.substream = r.varint();
      f.index = r.varint();
      f.count = r.varint();
      f.bytes = r.bytes(r.remaining());
      return f;
    }
    default: {
      const std::uint64_t back = r.varint();
      return PacketPart{back, r.bytes(r.remaining())};
    }
  }
}

}  // namespace

Result<std::optional<Part>> PartReader::next() noexcept {
  if (single_) {
    if (parts_++ > 0) return std::optional<Part>();
    return std::optional<Part>(PacketPart{0, reader_.bytes(reader_.remaining())});
  }
  while (reader_.remaining() > 0) {
    const std::uint64_t position = reader_.bit_offset();
    const std::uint8_t type = reader_.u8();
    const ByteReader part = reader_.sub(reader_.varint());
    if (reader_.overrun()) return fail(Errc::truncated, "R-SES-3", reader_.bit_offset());
    if (reader_.overlong()) return fail(Errc::malformed, "R-SES-3", reader_.bit_offset());
    if (type < last_ || type == 0) return fail(Errc::malformed, "R-SES-5", position);
    last_ = type;
    ++parts_;
    if (type >= kFirstSkipped) continue;
    if (type >= kFirstUnknown || !part_comes(type, direction_)) return fail(Errc::malformed, "R-SES-5", position);
    if (type >= kFragment && fragment_) return fail(Errc::malformed, "R-SES-5", position);
    fragment_ = type == kFragment;
    return read(type, part);
  }
  if (parts_ == 0 || (parts_ == 1 && only_packet_)) return fail(Errc::malformed, "R-SES-5", 8);
  return std::optional<Part>();
}

Result<std::optional<Part>> PartReader::read(std::uint8_t type, ByteReader part) noexcept {
  const Part out = read_part(type, direction_, part);
  TACTUS_CHECK(finished(part));
  const auto* state = std::get_if<StatePart>(&out);
  const auto* clock = std::get_if<ClockPart>(&out);
  if ((state != nullptr && state->live > 1) || (clock != nullptr && clock->time >= kEndOfTime))
    return fail(Errc::malformed, "R-SES-3", part.bit_offset());
  if (const auto* mapping = std::get_if<TickMappingPart>(&out); mapping != nullptr && !is_tick_mapping(*mapping))
    return fail(Errc::malformed, "R-SES-3", part.bit_offset());
  const auto* report = std::get_if<ReportPart>(&out);
  const auto* baselines = std::get_if<BaselinesPart>(&out);
  if ((report != nullptr && report->flags > (ReportPart::kKey | ReportPart::kView)) ||
      (baselines != nullptr && baselines->policy > 1))
    return fail(Errc::malformed, "R-SES-3", part.bit_offset());
  const auto* packet = std::get_if<PacketPart>(&out);
  only_packet_ = parts_ == 1 && packet != nullptr && packet->back == 0;
  return std::optional<Part>(out);
}

bool is_of_epoch(std::span<const std::uint8_t> datagram, std::uint64_t epoch, Direction direction) noexcept {
  if (datagram.size() < kHeadSize + kCheckSize || datagram.size() > kLargestDatagram) return false;
  const auto body = datagram.first(datagram.size() - kCheckSize);
  return ByteReader(datagram.last(kCheckSize)).u32() == check_of(body, epoch, direction);
}

bool is_before_epochs(std::span<const std::uint8_t> datagram) noexcept {
  if (datagram.size() < kHeadSize) return false;
  const std::uint16_t head = ByteReader(datagram).u16();
  return (head & 3u) == kHandshake && head >> 2 < kLeave;
}

Result<Datagram> read_datagram(std::span<const std::uint8_t> datagram, Direction direction) noexcept {
  if (datagram.size() < kHeadSize + kCheckSize || datagram.size() > kLargestDatagram) return fail(Errc::checksum, "R-SES-1");
  ByteReader r(datagram.first(datagram.size() - kCheckSize));
  const std::uint16_t head = r.u16();
  const std::uint16_t form = head & 3u;
  const auto value = static_cast<std::uint16_t>(head >> 2);
  if (form == kParts || form == kPacket) return read_numbered(r, value, form == kPacket, direction);
  if (form != kHandshake || !kind_comes(value, direction)) return fail(Errc::invalid, "R-SES-2");
  if (value == kJoin) return read_join(r);
  if (value == kWelcome) return read_welcome(r);
  const std::uint64_t nonce = value == kRefusal ? r.u64() : 0;
  TACTUS_TRY(const LeaveReason reason, read_reason(r));
  if (value == kRefusal) return handshake(r, Refusal{nonce, reason});
  return handshake(r, Leave{reason});
}

std::span<const std::uint8_t> DatagramWriter::with_check(std::size_t size, std::uint64_t epoch) noexcept {
  const std::uint32_t check = check_of(std::span(bytes_).first(size), epoch, direction_);
  return std::span(bytes_).first(Put(bytes_, size).integer(check, 4).at());
}

std::span<const std::uint8_t> DatagramWriter::write(const Datagram& message, std::uint64_t epoch) noexcept {
  Put to(bytes_, 0);
  std::visit([&](const auto& d) { put(to, d); }, message);
  return with_check(to.at(), epoch);
}

void DatagramWriter::begin(std::uint64_t number) noexcept {
  size_ = Put(bytes_, 0).integer(kParts + 4 * (number % kNumbers), 2).at();
  parts_ = single_ = 0;
  fragment_ = false;
}

bool DatagramWriter::add(const Part& part) noexcept {
  const std::uint8_t type = type_of(part);
  if (fragment_ && type >= kFragment) return false;
  const std::size_t size = std::visit([](const auto& p) { return size_of(p); }, part);
  Put to(std::span<std::uint8_t>(bytes_).first(kLargestDatagram - kCheckSize), size_);
  to.integer(type, 1).varint(size);
  if (!to.fits() || size > kLargestDatagram - kCheckSize - to.at()) return false;
  std::visit([&](const auto& p) { put(to, p); }, part);
  size_ = to.at();
  fragment_ = std::holds_alternative<FragmentPart>(part);
  const auto* packet = std::get_if<PacketPart>(&part);
  single_ = ++parts_ == 1 && packet != nullptr && packet->back == 0 ? size_ - packet->bytes.size() : 0;
  return true;
}

std::size_t DatagramWriter::room() const noexcept {
  constexpr std::size_t kPartHead = 1 + 2 + 12;  // type, size, and the numbers before the data
  return kLargestDatagram - kCheckSize - std::min(kLargestDatagram - kCheckSize, size_ + kPartHead);
}

std::span<const std::uint8_t> DatagramWriter::finish(std::uint64_t epoch) noexcept {
  if (single_ == 0) return with_check(size_, epoch);
  bytes_[0] = static_cast<std::uint8_t>((bytes_[0] & ~3u) | kPacket);
  std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(single_), bytes_.begin() + static_cast<std::ptrdiff_t>(size_),
            bytes_.begin() + kHeadSize);
  return with_check(kHeadSize + size_ - single_, epoch);
}

}  // namespace tactus
