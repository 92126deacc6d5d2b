// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/datagram.h>

#include <algorithm>

#include <tactus/base/rule.h>

namespace tactus {
namespace {

enum Kind : std::uint8_t { kJoin, kChallenge, kWelcome, kRefusal, kLeave, kParts, kPacket };
enum Type : std::uint8_t { kPacketPart = 1, kFragment, kAcknowledgement, kClock, kPiece, kReady, kHash, kEpoch, kFirstUnknown };

constexpr std::uint32_t kMagic = 0x53544354;  // "TCTS"
constexpr std::uint8_t kVersion = 1;
constexpr std::size_t kLeastJoin = 64;      // [bytes]: answers are shorter
constexpr std::uint8_t kFirstSkipped = 64;  // part types for later or private use
constexpr LeaveReason kLastReason = LeaveReason::protocol;

bool comes(Kind kind, Direction direction) noexcept {
  if (kind == kJoin) return direction == Direction::up;
  return kind == kLeave || kind >= kParts || direction == Direction::down;
}
bool comes(Type type, Direction direction) noexcept {
  if (type == kReady || type == kHash) return direction == Direction::up;
  return (type != kPiece && type != kEpoch) || direction == Direction::down;
}

/// Syntax of elements, and that nothing follows.
Result<void> finished(const ByteReader& reader) noexcept {
  if (reader.overrun()) return fail(Errc::truncated, "R-SES-3", reader.bit_offset());
  if (reader.overlong() || reader.remaining() > 0) return fail(Errc::malformed, "R-SES-3", reader.bit_offset());
  return {};
}

template <class T>
Result<Datagram> handshake(const ByteReader& reader, T said) noexcept {
  TACTUS_CHECK(finished(reader));
  return Datagram(std::move(said));
}

Epoch read_epoch(ByteReader& r) noexcept {
  Epoch out;
  out.epoch = r.u64();
  out.size = r.varint();
  out.hash = r.u64();
  out.start = r.varint();
  return out;
}

Result<Datagram> read_join(ByteReader& r, std::size_t size) noexcept {
  const std::uint32_t magic = r.u32();
  const std::uint8_t version = r.u8(), role = r.u8();
  if (r.ok() && (magic != kMagic || version != kVersion || role > static_cast<std::uint8_t>(Role::participant)))
    return fail(Errc::unsupported, "R-SES-9", 8);
  Join said;
  said.role = static_cast<Role>(role);
  said.nonce = r.u64();
  said.cookie = r.u64();
  said.state_limit = r.varint();
  said.packet_limit = r.varint();
  if (r.ok() && size < kLeastJoin) return fail(Errc::truncated, "R-SES-3", r.bit_offset());
  const std::uint64_t padding = r.bit_offset();
  const auto zeros = r.bytes(r.remaining());
  if (std::ranges::any_of(zeros, [](std::uint8_t byte) { return byte != 0; })) return fail(Errc::malformed, "R-SES-3", padding);
  return handshake(r, said);
}

Result<LeaveReason> read_reason(ByteReader& r) noexcept {
  const std::uint8_t reason = r.u8();
  if (reason > static_cast<std::uint8_t>(kLastReason)) return fail(Errc::malformed, "R-SES-3", r.bit_offset() - 8);
  return static_cast<LeaveReason>(reason);
}

Result<Datagram> read_numbered(ByteReader& r, bool single, Direction direction) noexcept {
  Numbered out;
  out.number = r.u16();
  if (!r.ok()) return fail(Errc::truncated, "R-SES-3", r.bit_offset());
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
  Put& epoch(const Epoch& e) noexcept { return integer(e.epoch, 8).varint(e.size).integer(e.hash, 8).varint(e.start); }
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

void put(Put& to, const Join& j) noexcept {
  to.integer(kJoin, 1).integer(kMagic, 4).integer(kVersion, 1).integer(static_cast<std::uint64_t>(j.role), 1);
  to.integer(j.nonce, 8).integer(j.cookie, 8).varint(j.state_limit).varint(j.packet_limit);
  while (to.at() < kLeastJoin) to.integer(0, 1);
}
void put(Put& to, const Challenge& c) noexcept { to.integer(kChallenge, 1).integer(c.nonce, 8).integer(c.cookie, 8); }
void put(Put& to, const Welcome& w) noexcept {
  to.integer(kWelcome, 1).integer(w.nonce, 8).integer(w.client, 2).epoch(w.epoch).varint(w.time);
}
void put(Put& to, const Refusal& r) noexcept {
  to.integer(kRefusal, 1).integer(r.nonce, 8).integer(static_cast<std::uint64_t>(r.reason), 1);
}
void put(Put& to, const Leave& l) noexcept { to.integer(kLeave, 1).integer(static_cast<std::uint64_t>(l.reason), 1); }
void put(Put&, const Numbered&) noexcept {}

std::size_t size_of(const PacketPart& p) noexcept { return varint_size(p.back) + p.bytes.size(); }
std::size_t size_of(const FragmentPart& f) noexcept { return varint_size(f.index) + varint_size(f.count) + f.bytes.size(); }
std::size_t size_of(const Acknowledgement& a) noexcept { return 4 + varint_size(a.missing); }
std::size_t size_of(const ClockPart& c) noexcept { return varint_size(c.time); }
std::size_t size_of(const PiecePart& p) noexcept { return varint_size(p.offset) + p.bytes.size(); }
std::size_t size_of(const ReadyPart&) noexcept { return 0; }
std::size_t size_of(const HashPart&) noexcept { return 7; }
std::size_t size_of(const Epoch& e) noexcept { return 16 + varint_size(e.size) + varint_size(e.start); }

void put(Put& to, const PacketPart& p) noexcept { to.varint(p.back).bytes(p.bytes); }
void put(Put& to, const FragmentPart& f) noexcept { to.varint(f.index).varint(f.count).bytes(f.bytes); }
void put(Put& to, const Acknowledgement& a) noexcept { to.integer(a.newest, 2).integer(a.held, 2).varint(a.missing); }
void put(Put& to, const ClockPart& c) noexcept { to.varint(c.time); }
void put(Put& to, const PiecePart& p) noexcept { to.varint(p.offset).bytes(p.bytes); }
void put(Put&, const ReadyPart&) noexcept {}
void put(Put& to, const HashPart& h) noexcept { to.integer(h.substream, 1).integer(h.number, 2).integer(h.hash, 4); }
void put(Put& to, const Epoch& e) noexcept { to.epoch(e); }

}  // namespace

Result<std::optional<Part>> PartReader::next() noexcept {
  if (single_) {
    if (parts_++ > 0) return std::optional<Part>();
    return std::optional<Part>(PacketPart{0, reader_.bytes(reader_.remaining())});
  }
  while (reader_.remaining() > 0) {
    const std::uint64_t place = reader_.bit_offset();
    const std::uint8_t type = reader_.u8();
    const ByteReader part = reader_.sub(reader_.varint());
    if (reader_.overrun()) return fail(Errc::truncated, "R-SES-3", reader_.bit_offset());
    if (reader_.overlong()) return fail(Errc::malformed, "R-SES-3", reader_.bit_offset());
    if (type < last_ || type == 0) return fail(Errc::malformed, "R-SES-5", place);
    last_ = type;
    ++parts_;
    if (type >= kFirstSkipped) continue;
    if (type >= kFirstUnknown || !comes(static_cast<Type>(type), direction_)) return fail(Errc::malformed, "R-SES-5", place);
    return read(type, part);
  }
  if (parts_ == 0 || (parts_ == 1 && only_packet_)) return fail(Errc::malformed, "R-SES-5", 8);
  return std::optional<Part>();
}

Result<std::optional<Part>> PartReader::read(std::uint8_t type, ByteReader part) noexcept {
  Part out;
  switch (type) {
    case kPacketPart: {
      const std::uint64_t back = part.varint();
      out = PacketPart{back, part.bytes(part.remaining())};
      only_packet_ = parts_ == 1 && back == 0;
      break;
    }
    case kFragment: {
      const std::uint64_t index = part.varint(), count = part.varint();
      const auto small = [](std::uint64_t v) { return static_cast<std::uint32_t>(std::min<std::uint64_t>(v, 0xffffffff)); };
      out = FragmentPart{small(index), small(count), part.bytes(part.remaining())};
      break;
    }
    case kAcknowledgement: {
      Acknowledgement a;
      a.newest = part.u16();
      a.held = part.u16();
      a.missing = part.varint();
      out = a;
      break;
    }
    case kClock:
      out = ClockPart{part.varint()};
      break;
    case kPiece: {
      const std::uint64_t offset = part.varint();
      out = PiecePart{offset, part.bytes(part.remaining())};
      break;
    }
    case kReady:
      out = ReadyPart{};
      break;
    case kHash: {
      HashPart h;
      h.substream = part.u8();
      h.number = part.u16();
      h.hash = part.u32();
      out = h;
      break;
    }
    default:
      out = read_epoch(part);
  }
  TACTUS_CHECK(finished(part));
  return std::optional<Part>(out);
}

Result<Datagram> read_datagram(std::span<const std::uint8_t> bytes, Direction direction) noexcept {
  ByteReader r(bytes);
  const std::uint8_t kind = r.u8();
  if (bytes.empty() || bytes.size() > kLargestDatagram || kind > kPacket || !comes(static_cast<Kind>(kind), direction))
    return fail(Errc::invalid, "R-SES-2");
  switch (kind) {
    case kJoin:
      return read_join(r, bytes.size());
    case kChallenge: {
      const std::uint64_t nonce = r.u64();
      return handshake(r, Challenge{nonce, r.u64()});
    }
    case kWelcome: {
      Welcome w;
      w.nonce = r.u64();
      w.client = r.u16();
      w.epoch = read_epoch(r);
      w.time = r.varint();
      return handshake(r, w);
    }
    case kRefusal: {
      const std::uint64_t nonce = r.u64();
      TACTUS_TRY(const LeaveReason reason, read_reason(r));
      return handshake(r, Refusal{nonce, reason});
    }
    case kLeave: {
      TACTUS_TRY(const LeaveReason reason, read_reason(r));
      return handshake(r, Leave{reason});
    }
    default:
      return read_numbered(r, kind == kPacket, direction);
  }
}

std::span<const std::uint8_t> DatagramWriter::write(const Datagram& said) noexcept {
  Put to(bytes_, 0);
  std::visit([&](const auto& d) { put(to, d); }, said);
  return std::span(bytes_).first(to.at());
}

void DatagramWriter::begin(std::uint16_t number) noexcept {
  size_ = Put(bytes_, 0).integer(kParts, 1).integer(number, 2).at();
  parts_ = single_ = 0;
}

bool DatagramWriter::add(const Part& part) noexcept {
  const std::size_t size = std::visit([](const auto& p) { return size_of(p); }, part);
  Put to(bytes_, size_);
  to.integer(part.index() + 1, 1).varint(size);
  if (!to.fits() || size > bytes_.size() - to.at()) return false;
  std::visit([&](const auto& p) { put(to, p); }, part);
  size_ = to.at();
  const auto* packet = std::get_if<PacketPart>(&part);
  single_ = ++parts_ == 1 && packet != nullptr && packet->back == 0 ? size_ - packet->bytes.size() : 0;
  return true;
}

std::size_t DatagramWriter::room() const noexcept {
  constexpr std::size_t kPartHead = 1 + 2 + 2;  // type, size, and a `back` below 2^14
  return bytes_.size() - std::min(bytes_.size(), size_ + kPartHead);
}

std::span<const std::uint8_t> DatagramWriter::finish() noexcept {
  if (single_ == 0) return std::span(bytes_).first(size_);
  constexpr std::size_t kHead = 3;
  bytes_[0] = kPacket;
  std::copy(bytes_.begin() + static_cast<std::ptrdiff_t>(single_), bytes_.begin() + static_cast<std::ptrdiff_t>(size_),
            bytes_.begin() + kHead);
  return std::span(bytes_).first(kHead + size_ - single_);
}

}  // namespace tactus
