// SPDX-License-Identifier: Apache-2.0
#include <tactus/session/datagram.h>

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace tactus {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::uint64_t kLarge = 0xfedcba9876543210;

Bytes copy(std::span<const std::uint8_t> bytes) { return {bytes.begin(), bytes.end()}; }

/// "R-SES-n" of a datagram that is refused, else nothing. Its check is not looked at.
std::string rule_of(const Bytes& bytes, Direction direction) {
  const auto read = read_datagram(bytes, direction);
  return read ? "" : read.error().rule;
}
/// The same of the bytes before the check.
std::string rule_of_body(Bytes body, Direction direction) {
  body.resize(body.size() + 4);
  return rule_of(body, direction);
}

const std::vector<Datagram> kHandshakes{Join{Role::participant, kLarge, 1u << 28, 1u << 26},
                                        Welcome{kLarge, 3, kLarge - 1, 513, 70000, kLarge - 5, 1234567},
                                        Refusal{3, LeaveReason::full}, Leave{LeaveReason::protocol}};
const std::vector<Direction> kComes{Direction::up, Direction::down, Direction::down, Direction::up};

template <class T>
bool equal(const Datagram& a, const Datagram& b) {
  return std::get_if<T>(&a) != nullptr && std::get_if<T>(&b) != nullptr && std::get<T>(a) == std::get<T>(b);
}
bool equal(const Datagram& a, const Datagram& b) {
  return equal<Join>(a, b) || equal<Welcome>(a, b) || equal<Refusal>(a, b) || equal<Leave>(a, b);
}

TEST(Datagram, HandshakesAreReadAsWritten) {
  for (std::size_t i = 0; i < kHandshakes.size(); ++i) {
    DatagramWriter writer(kComes[i]);
    const Bytes bytes = copy(writer.write(kHandshakes[i]));
    EXPECT_EQ(bytes[0], 4 * i);
    const auto read = read_datagram(bytes, kComes[i]);
    ASSERT_TRUE(read) << read.error().rule;
    EXPECT_TRUE(equal(*read, kHandshakes[i])) << i;
    for (std::size_t size = 2; size < bytes.size() - 4; ++size)
      EXPECT_EQ(rule_of_body(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)), kComes[i]), "R-SES-3")
          << size;
    Bytes longer(bytes.begin(), bytes.end() - 4);
    longer.push_back(1);
    EXPECT_EQ(rule_of_body(longer, kComes[i]), "R-SES-3");
    const Direction other = kComes[i] == Direction::up ? Direction::down : Direction::up;
    EXPECT_EQ(rule_of(bytes, other), i < 3 ? "R-SES-2" : "");
  }
}

TEST(Datagram, TheCheckBindsToEpochAndDirection) {
  DatagramWriter writer(Direction::up);
  Bytes bytes = copy(writer.write(Leave{}, kLarge));
  EXPECT_TRUE(is_of_epoch(bytes, kLarge, Direction::up));
  EXPECT_FALSE(is_of_epoch(bytes, kLarge, Direction::down));
  for (unsigned bit = 0; bit < 64; ++bit) EXPECT_FALSE(is_of_epoch(bytes, kLarge ^ std::uint64_t{1} << bit, Direction::up));
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    EXPECT_FALSE(is_of_epoch(bytes, kLarge, Direction::up)) << bit;
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
  }
  EXPECT_FALSE(is_of_epoch({}, 0, Direction::up));
  EXPECT_FALSE(is_of_epoch(Bytes(5), 0, Direction::up));
}

TEST(Datagram, AJoinIsNoShorterThanItsAnswers) {
  DatagramWriter up(Direction::up), down(Direction::down);
  const std::size_t join = up.write(Join{}).size();
  EXPECT_EQ(join, 80u);
  const std::uint64_t most = ~std::uint64_t{0};
  EXPECT_LE(down.write(Welcome{most, most, most, 65535, most, most, most}).size(), join);
  EXPECT_LE(down.write(Refusal{most, LeaveReason::protocol}).size(), join);
  Bytes padded = copy(up.write(Join{}));
  padded.resize(76);
  padded.resize(1200);
  EXPECT_EQ(rule_of(padded, Direction::up), "");
  padded.push_back(0);
  EXPECT_EQ(rule_of(padded, Direction::up), "R-SES-1");
}

TEST(Datagram, OfAJoinOfAnotherVersionTheNonceIsKnown) {
  DatagramWriter writer(Direction::up);
  Bytes join = copy(writer.write(Join{.role = Role::participant, .nonce = kLarge}));
  join[6] = 2;
  join[7] = 77;  // what the role became
  join[30] = 1;  // and what came after it
  const auto read = read_datagram(join, Direction::up);
  ASSERT_TRUE(read);
  EXPECT_FALSE(std::get<Join>(*read).is_known);
  EXPECT_EQ(std::get<Join>(*read).nonce, kLarge);
  join.resize(79);
  EXPECT_EQ(rule_of(join, Direction::up), "R-SES-3") << "too short for an answer";
}

TEST(Datagram, AStateIsLiveOrNot) {
  DatagramWriter writer(Direction::up);
  for (const std::uint8_t live : Bytes{0, 1, 2, 255}) {
    writer.begin(1);
    ASSERT_TRUE(writer.add(StatePart{live}));
    EXPECT_EQ(rule_of(copy(writer.finish(7)), Direction::up), live > 1 ? "R-SES-3" : "");
  }
}

TEST(Datagram, ClocksAreNotAtTheEndOfTime) {
  constexpr std::uint64_t kEnd = std::uint64_t{1} << 53;
  DatagramWriter writer(Direction::down);
  for (const std::uint64_t time : {kEnd - 1, kEnd, ~std::uint64_t{0}}) {
    writer.begin(1);
    ASSERT_TRUE(writer.add(ClockPart{time}));
    EXPECT_EQ(rule_of(copy(writer.finish(7)), Direction::down), time < kEnd ? "" : "R-SES-3");
    EXPECT_EQ(rule_of(copy(writer.write(Welcome{1, 0, 2, 3, 4, 5, time})), Direction::down), time < kEnd ? "" : "R-SES-3");
  }
}

TEST(Datagram, WhatIsNoJoinIsReported) {
  DatagramWriter writer(Direction::up);
  const Bytes join = copy(writer.write(Join{}));
  for (const std::size_t at : {2u, 5u, 7u}) {
    Bytes other = join;
    other[at] ^= 0x82;
    const auto read = read_datagram(other, Direction::up);
    ASSERT_FALSE(read);
    EXPECT_STREQ(read.error().rule, "R-SES-9") << at;
    EXPECT_EQ(read.error().code, Errc::unsupported);
  }
}

/// A datagram of every part that may go in a direction.
Bytes of_all_parts(Direction direction) {
  static const Bytes payload{1, 2, 3, 250};
  DatagramWriter writer(direction);
  writer.begin(0xabcd);
  EXPECT_TRUE(writer.add(Acknowledgement{65000, 17, kLarge}));
  if (direction == Direction::down) {
    EXPECT_TRUE(writer.add(ClockPart{1'000'000'000'000}));
    EXPECT_TRUE(writer.add(TickMappingPart{4'294'967'295, -(std::int64_t{1} << 33)}));
    EXPECT_TRUE(writer.add(PiecePart{70000, payload}));
    EXPECT_TRUE(writer.add(PiecePart{0, {}}));
    EXPECT_TRUE(writer.add(PacketPart{300, payload}));
    EXPECT_TRUE(writer.add(PacketPart{0, payload}));
  } else {
    EXPECT_TRUE(writer.add(ButtonsPart{4'000'000'000, 5}));
    EXPECT_TRUE(writer.add(StatePart{1}));
    EXPECT_TRUE(writer.add(HashPart{2, 500, 0x89abcdef}));
    EXPECT_TRUE(writer.add(FragmentPart{300, 4, 3, 200, payload}));
  }
  return copy(writer.finish(7));
}

std::vector<Part> parts_of(const Bytes& bytes, Direction direction) {
  const auto read = read_datagram(bytes, direction);
  EXPECT_TRUE(read) << read.error().rule;
  std::vector<Part> out;
  if (!read) return out;
  PartReader reader = std::get<Numbered>(*read).parts(direction);
  while (const auto part = reader.next().value()) out.push_back(*part);
  return out;
}

TEST(Datagram, PartsAreReadAsWritten) {
  const Bytes up = of_all_parts(Direction::up), down = of_all_parts(Direction::down);
  EXPECT_TRUE(is_of_epoch(up, 7, Direction::up));
  EXPECT_EQ(std::get<Numbered>(read_datagram(up, Direction::up).value()).number, 0xabcd % 16384);
  const auto sent = parts_of(up, Direction::up), got = parts_of(down, Direction::down);
  ASSERT_EQ(sent.size(), 5u);
  ASSERT_EQ(got.size(), 7u);
  EXPECT_EQ(std::get<Acknowledgement>(sent[0]), (Acknowledgement{65000, 17, kLarge}));
  EXPECT_EQ(std::get<ButtonsPart>(sent[1]), (ButtonsPart{4'000'000'000, 5}));
  EXPECT_EQ(std::get<StatePart>(sent[2]).live, 1);
  EXPECT_EQ(std::get<HashPart>(sent[3]).hash, 0x89abcdefu);
  EXPECT_EQ(std::get<HashPart>(sent[3]).number, 500u);
  EXPECT_EQ(std::get<FragmentPart>(sent[4]).back, 300u);
  EXPECT_EQ(std::get<FragmentPart>(sent[4]).substream, 4u);
  EXPECT_EQ(std::get<FragmentPart>(sent[4]).index, 3u);
  EXPECT_EQ(std::get<FragmentPart>(sent[4]).count, 200u);
  EXPECT_EQ(std::get<FragmentPart>(sent[4]).bytes.size(), 4u);
  EXPECT_EQ(std::get<PacketPart>(got[5]).back, 300u);
  EXPECT_EQ(copy(std::get<PacketPart>(got[6]).bytes), (Bytes{1, 2, 3, 250}));
  EXPECT_EQ(std::get<ClockPart>(got[1]).time, 1'000'000'000'000u);
  EXPECT_EQ(std::get<PiecePart>(got[3]).index, 70000u);
  EXPECT_TRUE(std::get<PiecePart>(got[4]).bytes.empty());
  EXPECT_EQ(std::get<TickMappingPart>(got[2]).from, 4'294'967'295);
  EXPECT_EQ(std::get<TickMappingPart>(got[2]).offset, -(std::int64_t{1} << 33));
  EXPECT_EQ(rule_of(up, Direction::down), "R-SES-3") << "buttons are no tick mapping";
  EXPECT_EQ(rule_of(down, Direction::up), "R-SES-5");
}

TEST(Datagram, APacketAloneHasSixBytesAroundIt) {
  const Bytes packet(40, 9);
  DatagramWriter writer(Direction::down);
  writer.begin(5);
  ASSERT_TRUE(writer.add(PacketPart{0, packet}));
  const Bytes bytes = copy(writer.finish(1));
  EXPECT_EQ(bytes.size(), 46u);
  const auto parts = parts_of(bytes, Direction::down);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(copy(std::get<PacketPart>(parts[0]).bytes), packet);
  Bytes spelled{21, 0, 8, 41, 0};
  spelled.insert(spelled.end(), packet.begin(), packet.end());
  EXPECT_EQ(rule_of_body(spelled, Direction::down), "R-SES-5") << "one value has one encoding";
  spelled[4] = 1;
  EXPECT_EQ(rule_of_body(spelled, Direction::down), "") << "a packet of an older number";
}

TEST(Datagram, PartsOutOfOrderAreRefused) {
  const Direction down = Direction::down;
  EXPECT_EQ(rule_of_body({5, 0, 2, 1, 0, 1, 5, 0, 0, 0, 0, 0}, down), "R-SES-5") << "clock before acknowledgement";
  EXPECT_EQ(rule_of_body({5, 0, 1, 5, 0, 0, 0, 0, 0, 2, 1, 0}, down), "");
  EXPECT_EQ(rule_of_body({5, 0}, down), "R-SES-5") << "no part";
  EXPECT_EQ(rule_of_body({5}, down), "R-SES-1");
  EXPECT_EQ(rule_of_body({5, 0, 0, 0}, down), "R-SES-5");
  EXPECT_EQ(rule_of_body({5, 0, 9, 0}, down), "R-SES-5") << "not known";
  EXPECT_EQ(rule_of_body({5, 0, 63, 0}, down), "R-SES-5");
  EXPECT_EQ(rule_of_body({5, 0, 2, 1, 0, 64, 2, 7, 7, 255, 1, 0}, down), "") << "for later";
  EXPECT_EQ(rule_of_body({5, 0, 64, 3, 7, 7}, down), "R-SES-3");
  EXPECT_EQ(rule_of_body({5, 0, 2, 2, 0, 0}, down), "R-SES-3") << "bytes too many in a part";
  EXPECT_EQ(rule_of_body({5, 0, 2, 2, 128, 0}, down), "R-SES-3") << "not the shortest varint";
  EXPECT_EQ(rule_of_body({7, 0}, down), "R-SES-2") << "reserved form";
  EXPECT_EQ(rule_of_body({16, 0}, down), "R-SES-2") << "unknown kind";
  EXPECT_EQ(rule_of({}, down), "R-SES-1");
}

TEST(Datagram, WhatDoesNotFitIsNotAdded) {
  const Bytes bytes(2000, 3);
  DatagramWriter writer(Direction::down);
  for (const std::size_t before : {0u, 1u, 300u}) {
    writer.begin(1);
    ASSERT_TRUE(writer.add(PacketPart{1, std::span(bytes).first(before)}));
    const std::size_t room = writer.room();
    EXPECT_GT(room, 1100 - before);
    EXPECT_FALSE(writer.add(PacketPart{2, std::span(bytes).first(room + 16)}));
    EXPECT_FALSE(writer.add(PacketPart{2, bytes}));
    ASSERT_TRUE(writer.add(PacketPart{2, std::span(bytes).first(room)}));
    const Bytes written = copy(writer.finish(1));
    EXPECT_LE(written.size(), kLargestDatagram);
    EXPECT_EQ(parts_of(written, Direction::down).size(), 2u);
  }
}

/// Whatever is accepted is written again as the same bytes.
TEST(Datagram, OfAnyBytesWhatIsTakenIsCanonical) {
  std::mt19937_64 random(1);
  std::size_t taken = 0;
  for (int run = 0; run < 200000; ++run) {
    const Direction direction = run % 2 == 0 ? Direction::up : Direction::down;
    Bytes bytes = run % 3 == 0 ? of_all_parts(direction) : Bytes(6 + random() % 20);
    if (run % 3 != 0) {
      for (auto& b : bytes) b = static_cast<std::uint8_t>(random() % (random() % 4 == 0 ? 256 : 9));
    }
    for (std::uint64_t flips = random() % 4; flips > 0; --flips)
      bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
    const auto read = read_datagram(bytes, direction);
    if (!read) continue;
    const Bytes body(bytes.begin(), bytes.end() - 4);
    DatagramWriter writer(direction);
    const auto* numbered = std::get_if<Numbered>(&*read);
    if (numbered == nullptr) {
      const Bytes again = copy(writer.write(*read));
      EXPECT_EQ(Bytes(again.begin(), again.end() - 4), body);
      continue;
    }
    writer.begin(numbered->number);
    PartReader parts = numbered->parts(direction);
    while (const auto part = parts.next().value()) ASSERT_TRUE(writer.add(*part));
    if (writer.empty()) continue;  // parts for later only
    const Bytes again = copy(writer.finish(0));
    EXPECT_TRUE(Bytes(again.begin(), again.end() - 4) == body || again.size() < bytes.size());
    ++taken;
  }
  EXPECT_GT(taken, 1000u);
}

}  // namespace
}  // namespace tactus
