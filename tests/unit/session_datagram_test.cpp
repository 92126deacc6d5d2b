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

/// "R-SES-n" of a datagram that is refused, else nothing.
std::string rule_of(const Bytes& bytes, Direction direction) {
  const auto read = read_datagram(bytes, direction);
  return read ? "" : read.error().rule;
}

const Epoch kScene{kLarge, 70000, kLarge - 5, 1234567};
const std::vector<Datagram> kHandshakes{Join{Role::participant, kLarge, 7, 1u << 28, 1u << 26}, Challenge{1, kLarge},
                                        Welcome{kLarge, 513, kScene, 99}, Refusal{3, LeaveReason::full},
                                        Leave{LeaveReason::protocol}};
const std::vector<Direction> kComes{Direction::up, Direction::down, Direction::down, Direction::down, Direction::up};

template <class T>
bool equal(const Datagram& a, const Datagram& b) {
  return std::get_if<T>(&a) != nullptr && std::get_if<T>(&b) != nullptr && std::get<T>(a) == std::get<T>(b);
}
bool equal(const Datagram& a, const Datagram& b) {
  return equal<Join>(a, b) || equal<Challenge>(a, b) || equal<Welcome>(a, b) || equal<Refusal>(a, b) || equal<Leave>(a, b);
}

TEST(Datagram, HandshakesAreReadAsWritten) {
  DatagramWriter writer;
  for (std::size_t i = 0; i < kHandshakes.size(); ++i) {
    const Bytes bytes = copy(writer.write(kHandshakes[i]));
    EXPECT_EQ(bytes[0], i);
    const auto read = read_datagram(bytes, kComes[i]);
    ASSERT_TRUE(read) << read.error().rule;
    EXPECT_TRUE(equal(*read, kHandshakes[i])) << i;
    for (std::size_t size = 1; size < bytes.size(); ++size)
      EXPECT_EQ(rule_of(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)), kComes[i]), "R-SES-3") << size;
    Bytes longer = bytes;
    longer.push_back(1);
    EXPECT_EQ(rule_of(longer, kComes[i]), "R-SES-3");
    if (i < 4) {
      EXPECT_EQ(rule_of(bytes, kComes[i] == Direction::up ? Direction::down : Direction::up), "R-SES-2");
    }
  }
}

TEST(Datagram, AJoinIsNoShorterThanItsAnswers) {
  DatagramWriter writer;
  const std::size_t join = writer.write(Join{}).size();
  EXPECT_EQ(join, 64u);
  const std::uint64_t most = ~std::uint64_t{0};
  EXPECT_LE(writer.write(Challenge{most, most}).size(), join);
  EXPECT_LE(writer.write(Refusal{most, LeaveReason::protocol}).size(), join);
  Bytes padded = copy(writer.write(Join{}));
  padded.resize(1200);
  EXPECT_EQ(rule_of(padded, Direction::up), "");
  padded.push_back(0);
  EXPECT_EQ(rule_of(padded, Direction::up), "R-SES-2");
}

TEST(Datagram, OtherVersionsAreTold) {
  DatagramWriter writer;
  const Bytes join = copy(writer.write(Join{}));
  for (const std::size_t at : {1u, 4u, 5u, 6u}) {
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
  DatagramWriter writer;
  writer.begin(0xabcd);
  const bool down = direction == Direction::down;
  EXPECT_TRUE(writer.add(PacketPart{300, payload}));
  EXPECT_TRUE(writer.add(FragmentPart{3, 200, payload}));
  EXPECT_TRUE(writer.add(Acknowledgement{65000, 17, kLarge}));
  EXPECT_TRUE(writer.add(ClockPart{1'000'000'000'000}));
  if (down) {
    EXPECT_TRUE(writer.add(PiecePart{70000, payload}));
    EXPECT_TRUE(writer.add(PiecePart{0, {}}));
  } else {
    EXPECT_TRUE(writer.add(ReadyPart{}));
    EXPECT_TRUE(writer.add(HashPart{2, 500, 0x89abcdef}));
  }
  if (down) {
    EXPECT_TRUE(writer.add(kScene));
  }
  return copy(writer.finish());
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
  EXPECT_EQ(std::get<Numbered>(read_datagram(up, Direction::up).value()).number, 0xabcd);
  const auto sent = parts_of(up, Direction::up), got = parts_of(down, Direction::down);
  ASSERT_EQ(sent.size(), 6u);
  ASSERT_EQ(got.size(), 7u);
  EXPECT_EQ(std::get<PacketPart>(sent[0]).back, 300u);
  EXPECT_EQ(copy(std::get<PacketPart>(sent[0]).bytes), (Bytes{1, 2, 3, 250}));
  EXPECT_EQ(std::get<FragmentPart>(sent[1]).index, 3u);
  EXPECT_EQ(std::get<FragmentPart>(sent[1]).count, 200u);
  EXPECT_EQ(std::get<FragmentPart>(sent[1]).bytes.size(), 4u);
  EXPECT_EQ(std::get<Acknowledgement>(sent[2]), (Acknowledgement{65000, 17, kLarge}));
  EXPECT_EQ(std::get<ClockPart>(sent[3]).time, 1'000'000'000'000u);
  EXPECT_TRUE(std::holds_alternative<ReadyPart>(sent[4]));
  EXPECT_EQ(std::get<HashPart>(sent[5]).hash, 0x89abcdefu);
  EXPECT_EQ(std::get<HashPart>(sent[5]).number, 500u);
  EXPECT_EQ(std::get<PiecePart>(got[4]).offset, 70000u);
  EXPECT_TRUE(std::get<PiecePart>(got[5]).bytes.empty());
  EXPECT_EQ(std::get<Epoch>(got[6]), kScene);
  EXPECT_EQ(rule_of(up, Direction::down), "R-SES-5");
  EXPECT_EQ(rule_of(down, Direction::up), "R-SES-5");
}

TEST(Datagram, APacketAloneHasThreeBytesBeforeIt) {
  const Bytes packet(40, 9);
  DatagramWriter writer;
  writer.begin(5);
  ASSERT_TRUE(writer.add(PacketPart{0, packet}));
  const Bytes bytes = copy(writer.finish());
  EXPECT_EQ(bytes.size(), 43u);
  const auto parts = parts_of(bytes, Direction::down);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(copy(std::get<PacketPart>(parts[0]).bytes), packet);
  Bytes spelled{5, 5, 0, 1, 41, 0};
  spelled.insert(spelled.end(), packet.begin(), packet.end());
  EXPECT_EQ(rule_of(spelled, Direction::down), "R-SES-5") << "one value has one encoding";
  spelled[5] = 1;
  EXPECT_EQ(rule_of(spelled, Direction::down), "") << "a packet of an older number";
}

TEST(Datagram, PartsOutOfOrderAreRefused) {
  EXPECT_EQ(rule_of({5, 1, 0, 4, 1, 0, 3, 5, 0, 0, 0, 0, 0}, Direction::up), "R-SES-5") << "clock before acknowledgement";
  EXPECT_EQ(rule_of({5, 1, 0, 3, 5, 0, 0, 0, 0, 0, 4, 1, 0}, Direction::up), "");
  EXPECT_EQ(rule_of({5, 1, 0}, Direction::up), "R-SES-5") << "no part";
  EXPECT_EQ(rule_of({5, 1}, Direction::up), "R-SES-3");
  EXPECT_EQ(rule_of({5, 1, 0, 0, 0}, Direction::up), "R-SES-5");
  EXPECT_EQ(rule_of({5, 1, 0, 9, 0}, Direction::up), "R-SES-5") << "not known";
  EXPECT_EQ(rule_of({5, 1, 0, 63, 0}, Direction::up), "R-SES-5");
  EXPECT_EQ(rule_of({5, 1, 0, 4, 1, 0, 64, 2, 7, 7, 255, 0}, Direction::up), "") << "for later";
  EXPECT_EQ(rule_of({5, 1, 0, 64, 3, 7, 7}, Direction::up), "R-SES-3");
  EXPECT_EQ(rule_of({5, 1, 0, 4, 2, 0, 0}, Direction::up), "R-SES-3") << "bytes too many in a part";
  EXPECT_EQ(rule_of({5, 1, 0, 4, 2, 128, 0}, Direction::up), "R-SES-3") << "not the shortest varint";
  EXPECT_EQ(rule_of({7, 1, 0}, Direction::up), "R-SES-2");
  EXPECT_EQ(rule_of({}, Direction::up), "R-SES-2");
}

TEST(Datagram, WhatDoesNotFitIsNotAdded) {
  const Bytes bytes(2000, 3);
  DatagramWriter writer;
  for (const std::size_t before : {0u, 1u, 300u}) {
    writer.begin(1);
    ASSERT_TRUE(writer.add(PacketPart{1, std::span(bytes).first(before)}));
    const std::size_t room = writer.room();
    EXPECT_GT(room, 1100 - before);
    EXPECT_FALSE(writer.add(PacketPart{2, std::span(bytes).first(room + 6)}));
    EXPECT_FALSE(writer.add(PacketPart{2, bytes}));
    ASSERT_TRUE(writer.add(PacketPart{2, std::span(bytes).first(room)}));
    const Bytes written = copy(writer.finish());
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
    Bytes bytes = run % 3 == 0 ? of_all_parts(direction) : Bytes(1 + random() % 20);
    if (run % 3 != 0) {
      for (auto& b : bytes) b = static_cast<std::uint8_t>(random() % (random() % 4 == 0 ? 256 : 8));
    }
    for (std::uint64_t flips = random() % 4; flips > 0; --flips)
      bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
    const auto read = read_datagram(bytes, direction);
    if (!read) continue;
    DatagramWriter writer;
    const auto* numbered = std::get_if<Numbered>(&*read);
    if (numbered == nullptr) {
      EXPECT_EQ(copy(writer.write(*read)), bytes);
      continue;
    }
    writer.begin(numbered->number);
    PartReader parts = numbered->parts(direction);
    std::size_t skipped = bytes.size();
    while (const auto part = parts.next().value()) ASSERT_TRUE(writer.add(*part));
    if (writer.empty()) continue;  // parts for later only
    const Bytes again = copy(writer.finish());
    skipped -= again.size();
    EXPECT_TRUE(again == bytes || skipped > 0);
    ++taken;
  }
  EXPECT_GT(taken, 1000u);
}

}  // namespace
}  // namespace tactus
