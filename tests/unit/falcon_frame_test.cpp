// SPDX-License-Identifier: Apache-2.0
#include <tactus/device/falcon/falcon_frame.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "tests/property/allocated.h"
#include "tests/unit/falcon_fixture.h"

namespace tactus::device::falcon {
namespace {

using testing::frame_of;
using Bytes = std::vector<std::uint8_t>;

struct Heard {
  std::vector<Reply> replies;
  int broken = 0;
  friend bool operator==(const Heard&, const Heard&) = default;
};

void hear(ReplyParser& parser, const Bytes& transfer, Heard& heard) {
  parser.give(transfer);
  while (const auto next = parser.next()) {
    if (*next) {
      heard.replies.push_back(**next);
    } else {
      EXPECT_EQ(next->error().code, Errc::malformed);
      EXPECT_STREQ(next->error().rule, "R-DEV-5");
      ++heard.broken;
    }
  }
}

/// In transfers of so many bytes, modem bytes before each; those look like the beginning of a frame.
Heard heard_in(const Bytes& bytes, std::size_t piece = 62) {
  ReplyParser parser;
  Heard out;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    Bytes transfer{'<', '<'};
    transfer.insert(transfer.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
                    bytes.begin() + static_cast<std::ptrdiff_t>(std::min(at + piece, bytes.size())));
    hear(parser, transfer, out);
  }
  return out;
}

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

constexpr Reply kReply{{-32768, 0x1234, -1}, 5, 3};

TEST(FalconFrame, RequestsAreWrittenDigitByDigit) {
  const Frame frame = encode({{0x1234, -1, -4096}, Light::red});
  EXPECT_EQ(std::string(frame.begin(), frame.end()), "<EDCBPPPPAAAPJA>");
  const Frame none = encode({});
  EXPECT_EQ(std::string(none.begin(), none.end()), "<AAAAAAAAAAAABA>");
}

TEST(FalconFrame, RepliesComeBackAsSaid) {
  for (int value = -32768; value <= 32767; value += 13) {
    const auto count = static_cast<std::int16_t>(value);
    const Reply reply{{count, static_cast<std::int16_t>(-count / 2), static_cast<std::int16_t>(~count)},
                      static_cast<std::uint8_t>(value & 15),
                      static_cast<std::uint8_t>(value & 7)};
    EXPECT_EQ(heard_in(frame_of(reply)), (Heard{{reply}, 0}));
  }
}

TEST(FalconFrame, TransfersEndAnywhere) {
  const Reply other{{1, 2, 3}, 0, 7};
  const Bytes both = frame_of(kReply) + frame_of(other);
  for (std::size_t piece = 1; piece <= both.size(); ++piece)
    EXPECT_EQ(heard_in(both, piece), (Heard{{kReply, other}, 0})) << piece;
  ReplyParser parser;
  Heard heard;
  for (const Bytes& few : {Bytes{}, Bytes{1}, Bytes{1, 2}}) hear(parser, few, heard);
  EXPECT_EQ(heard, Heard{});
}

TEST(FalconFrame, EveryPacketOfALongTransferHasModemBytes) {
  Bytes bytes, transfer;
  for (int i = 0; i < 8; ++i) bytes = bytes + frame_of(kReply);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    if (i % 62 == 0) transfer = transfer + Bytes{'<', '>'};
    transfer.push_back(bytes[i]);
  }
  ReplyParser parser;
  Heard heard;
  hear(parser, transfer, heard);
  EXPECT_EQ(heard, (Heard{std::vector<Reply>(8, kReply), 0}));
}

TEST(FalconFrame, APrefixIsNoFrameAndTheNextOneIsRead) {
  const Bytes whole = frame_of(kReply);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const Bytes prefix(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_EQ(heard_in(prefix), Heard{});
    EXPECT_EQ(heard_in(prefix + whole), (Heard{{kReply}, size > 0 ? 1 : 0})) << size;
  }
}

TEST(FalconFrame, EveryBitFlipIsSeenOrChangesOnlyValues) {
  const Bytes whole = frame_of(kReply);
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    Bytes flipped = whole;
    flipped[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    const Heard heard = heard_in(flipped + whole);
    ASSERT_FALSE(heard.replies.empty()) << bit;
    EXPECT_EQ(heard.replies.back(), kReply);
    // Without '<' no frame begins; '<' in place of '>' begins one more.
    const std::size_t begun = bit / 8 == 0 ? 1 : flipped[15] == '<' ? 3 : 2;
    EXPECT_EQ(heard.replies.size() + static_cast<std::size_t>(heard.broken), begun) << bit;
  }
}

TEST(FalconFrame, NoByteOutsideItsRangeIsTaken) {
  for (std::size_t place = 1; place < kFrameBytes; ++place) {
    for (int value = 0; value < 256; ++value) {
      Bytes changed = frame_of(kReply);
      changed[place] = static_cast<std::uint8_t>(value);
      const bool fits = place == 14   ? value != '<'
                        : place == 15 ? value == '>'
                                      : value >= 0x41 && value <= (place == 13 ? 0xc0 : 0x50);
      EXPECT_EQ(heard_in(changed).replies.size(), fits ? 1u : 0u) << place << ' ' << value;
    }
  }
}

TEST(FalconFrame, GarbageHidesNoFrame) {
  std::srand(7);
  for (int round = 0; round < 2000; ++round) {
    Bytes garbage(static_cast<std::size_t>(std::rand() % 100));
    for (std::uint8_t& byte : garbage) byte = static_cast<std::uint8_t>(std::rand() % 4 == 0 ? '<' : std::rand());
    const Heard heard = heard_in(garbage + frame_of(kReply), 1 + static_cast<std::size_t>(std::rand() % 62));
    ASSERT_FALSE(heard.replies.empty());
    EXPECT_EQ(heard.replies.back(), kReply);
  }
}

TEST(FalconFrame, NothingIsAllocated) {
  const Bytes whole = frame_of(kReply) + Bytes{'<', 'x'} + frame_of(kReply);
  ReplyParser parser;
  const std::uint64_t before = testing::allocated_bytes();
  int seen = 0;
  parser.give(whole);
  while (parser.next()) ++seen;
  EXPECT_EQ(encode({})[0], '<');
  EXPECT_EQ(testing::allocated_bytes(), before);
  EXPECT_EQ(seen, 2);  // without the first frame, whose first bytes are taken for the modem's
}

}  // namespace
}  // namespace tactus::device::falcon
