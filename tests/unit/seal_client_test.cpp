// SPDX-License-Identifier: Apache-2.0
/// The handshake over networks that lose, double and damage, and what a client says when there is none.
#include <tactus/seal/seal_client.h>

#include <deque>
#include <random>

#include "tests/unit/seal_fixture.h"

namespace tactus {
namespace {

using testing::Bytes;
using testing::bytes_of;
using testing::key_of;
using testing::SealPair;

TEST(SealClient, HandsDatagramsOverBothWays) {
  SealPair pair;
  EXPECT_FALSE(pair.client.is_open());
  pair.run();
  ASSERT_TRUE(pair.client.is_open());
  EXPECT_TRUE(pair.say_up("up"));
  pair.down(pair.sealed_down("down"));
  EXPECT_EQ(pair.heard_up, std::vector<Bytes>{bytes_of("up")});
  EXPECT_EQ(pair.heard_down, std::vector<Bytes>{bytes_of("down")});
  EXPECT_EQ(pair.client.counters().handshakes, 1u);
  EXPECT_EQ(pair.server.counters().handshakes, 1u);
  EXPECT_EQ(pair.server.counters().cookies, 1u);
  EXPECT_FALSE(pair.client.next_timeout());
}

TEST(SealClient, ARecordIs29BytesLongerAndHidesItsContent) {
  SealPair pair;
  pair.run();
  for (const std::size_t size : {std::size_t{1}, std::size_t{30}, seal::kLargestPlain}) {
    const std::string text(size, 'T');
    const Bytes up = pair.sealed_up(text);
    EXPECT_EQ(up.size(), size + 29);
    EXPECT_EQ(up.size(), size + seal::kOverhead);
    if (size >= 4) {
      EXPECT_EQ(std::string(up.begin(), up.end()).find("TTTT"), std::string::npos);
    }
    pair.up(up);
    EXPECT_EQ(pair.heard_up.back(), bytes_of(text));
  }
  for (const std::size_t size : {std::size_t{0}, seal::kLargestPlain + 1}) {
    const auto refused = pair.client.seal(Bytes(size));
    ASSERT_FALSE(refused);
    EXPECT_STREQ(refused.error().rule, "R-SEA-5");
  }
  EXPECT_TRUE(pair.say_up("still there"));
}

/// Every loss of one datagram of the handshake, then of two in a row.
TEST(SealClient, AnyDatagramOfTheHandshakeMayBeLost) {
  for (int lost = 0; lost < 8; ++lost) {
    for (int row = 1; row <= 2; ++row) {
      SealPair pair;
      int sent = 0;
      const auto network = [&](const Bytes& datagram) {
        const int number = sent++;
        return number >= lost && number < lost + row ? std::vector<Bytes>{} : std::vector<Bytes>{datagram};
      };
      pair.network_up = pair.network_down = network;
      pair.run(9'000'000);
      EXPECT_TRUE(pair.client.is_open()) << lost << " and " << row;
      EXPECT_EQ(pair.server.peers(), 1u) << lost << " and " << row;
    }
  }
}

TEST(SealClient, ManyLossesDoublesAndReversals) {
  int open = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    SealPair pair;
    std::mt19937 random(seed);
    std::deque<Bytes> late[2];
    const auto network = [&random](std::deque<Bytes>& held) {
      return [&random, &held](const Bytes& datagram) {
        std::vector<Bytes> out;
        if (random() % 10 < 3) return out;
        if (random() % 8 == 0) {  // after the next
          held.push_back(datagram);
          return out;
        }
        out.push_back(datagram);
        if (random() % 5 == 0) out.push_back(datagram);
        for (; !held.empty(); held.pop_front()) out.push_back(held.front());
        return out;
      };
    };
    pair.network_up = network(late[0]);
    pair.network_down = network(late[1]);
    pair.run(10'000'000);
    open += pair.client.is_open() ? 1 : 0;
    if (!pair.client.is_open()) continue;
    pair.network_up = [](const Bytes& datagram) { return std::vector<Bytes>{datagram}; };
    ASSERT_TRUE(pair.say_up("hello")) << seed;
    EXPECT_EQ(pair.heard_up, std::vector<Bytes>{bytes_of("hello")}) << seed;
  }
  EXPECT_GE(open, 39);  // more than half of the exchanges fail
}

TEST(SealClient, NoiseInTheHandshakeIsNoEnd) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SealPair pair;
    std::mt19937 random(seed);
    pair.network_down = pair.network_up = [&random](const Bytes& datagram) {
      if (random() % 3 != 0) return std::vector<Bytes>{datagram};
      Bytes damaged = datagram;
      damaged[random() % damaged.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
      return std::vector<Bytes>{damaged};
    };
    pair.run(9'900'000);
    EXPECT_EQ(pair.error, "") << seed;
    pair.network_up = [](const Bytes& datagram) { return std::vector<Bytes>{datagram}; };
    if (pair.client.is_open()) {
      EXPECT_TRUE(pair.say_up("hello"));
      EXPECT_EQ(pair.heard_up, std::vector<Bytes>{bytes_of("hello")}) << seed;
    }
  }
}

TEST(SealClient, AnotherSecretAndAnotherNameAreRefusedAlike) {
  std::vector<std::size_t> largest;
  for (const auto& [name, byte] : {std::pair("lab", "5b"), std::pair("lob", "5a"), std::pair("lob", "5b")}) {
    SealPair pair(key_of(name, byte));
    const std::uint64_t began = pair.now;
    pair.run();
    EXPECT_EQ(pair.error, "R-SEA-2") << name << byte;
    EXPECT_EQ(pair.now - began, 10'010'000u);
    EXPECT_EQ(pair.server.peers(), 0u);
    EXPECT_EQ(pair.server.counters().handshakes, 0u);
    EXPECT_FALSE(pair.client.seal(bytes_of("x")));
    largest.push_back(pair.largest_down);
    pair.now += 11'000'000;
    pair.server.work(pair.now);
    EXPECT_EQ(pair.server.handshakes(), 0u) << "forgotten";
  }
  EXPECT_EQ(largest[0], largest[1]) << "a stranger cannot tell a known name from an unknown one";
}

TEST(SealClient, WhereNobodyAnswersItGivesUp) {
  SealPair pair;
  std::vector<std::uint64_t> sent;
  pair.network_up = [&](const Bytes&) {
    sent.push_back((pair.now - 5'000'000) / 10'000 * 10);
    return std::vector<Bytes>{};
  };
  pair.run();
  EXPECT_EQ(pair.error, "R-SEA-1");
  EXPECT_EQ(sent, (std::vector<std::uint64_t>{0,    250,  750,  1250, 1750, 2250, 2750, 3250, 3500, 4000, 4500,
                                              5000, 5500, 6000, 6500, 6750, 7250, 7750, 8250, 8750, 9250, 9750}));
  EXPECT_TRUE(pair.client.handle_timeout(pair.now + 1)) << "an end is reported once";
}

TEST(SealClient, HearsNothingButItsServerBeforeItIsOpen) {
  SealPair other, pair;
  other.run();
  other.say_up("x");
  pair.down(other.sealed_down("data of another association"));
  pair.down(bytes_of("not a record"));
  pair.down({});
  pair.down(Bytes(2000, 22));
  EXPECT_TRUE(pair.heard_down.empty());
  pair.run();
  EXPECT_TRUE(pair.client.is_open());
  EXPECT_EQ(pair.error, "");
}

/// What a server sends after its cookie, sent by someone else before it.
TEST(SealClient, AFlightBeforeTheCookieDelaysNothing) {
  std::vector<Bytes> flight;
  SealPair other, quiet, disturbed;
  other.network_down = [&flight](const Bytes& datagram) {
    flight.push_back(datagram);
    return std::vector<Bytes>{datagram};
  };
  other.run();
  ASSERT_GT(flight.size(), 1u);
  quiet.run();
  for (std::size_t i = 1; i < flight.size(); ++i) disturbed.down(flight[i]);
  disturbed.run();
  EXPECT_TRUE(disturbed.client.is_open());
  EXPECT_EQ(disturbed.now, quiet.now);
}

TEST(SealClient, ForgedAlertsAreIgnored) {
  const Bytes fatal{21, 0xFE, 0xFD, 0, 0, 0, 0, 0, 0, 0, 9, 0, 2, 2, 40};
  const Bytes close{21, 0xFE, 0xFD, 0, 0, 0, 0, 0, 0, 0, 10, 0, 2, 1, 0};
  Bytes in_epoch_1 = close;
  in_epoch_1[4] = 1;
  SealPair pair;
  for (const Bytes& alert : {fatal, close, in_epoch_1}) {
    pair.down(alert);
    pair.up(alert);
  }
  pair.run();
  ASSERT_TRUE(pair.client.is_open());
  for (const Bytes& alert : {fatal, close, in_epoch_1}) {
    pair.down(alert);
    pair.up(alert);
  }
  EXPECT_EQ(pair.error, "");
  EXPECT_TRUE(pair.say_up("still there"));
  EXPECT_EQ(pair.heard_up.size(), 1u);
}

TEST(SealClient, ReplaysAndForgeriesAreCountedAndDropped) {
  SealPair pair;
  pair.run();
  pair.say_up("x");
  const Bytes sealed = pair.sealed_down("once");
  for (int i = 0; i < 3; ++i) pair.down(sealed);
  EXPECT_EQ(pair.heard_down.size(), 1u);
  EXPECT_EQ(pair.client.counters().replayed, 2u);
  const Bytes next = pair.sealed_down("next");
  for (std::size_t bit = 0; bit < 8 * next.size(); ++bit) {
    Bytes damaged = next;
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1u << bit % 8);
    pair.down(damaged);
  }
  for (std::size_t size = 0; size < next.size(); ++size) pair.down(Bytes(next.begin(), next.begin() + static_cast<long>(size)));
  Bytes longer = next;
  longer.push_back(0);
  pair.down(longer);
  EXPECT_EQ(pair.heard_down.size(), 1u);
  EXPECT_GE(pair.client.counters().unauthentic, 8 * (next.size() - 13));
  pair.down(next);
  EXPECT_EQ(pair.heard_down.size(), 2u);
  EXPECT_EQ(pair.error, "");
}

TEST(SealClient, RecordsMayBeReorderedButNotByMoreThanTheWindow) {
  SealPair pair;
  pair.run();
  pair.say_up("x");
  std::vector<Bytes> sent;
  for (int i = 0; i < 200; ++i) sent.push_back(pair.sealed_down("datagram"));
  pair.down(sent[100]);
  pair.down(sent[60]);
  pair.down(sent[199]);
  EXPECT_EQ(pair.heard_down.size(), 3u);
  pair.down(sent[101]);
  EXPECT_EQ(pair.heard_down.size(), 3u) << "98 back: nobody remembers whether it came";
  EXPECT_EQ(pair.client.counters().replayed, 1u);
  pair.down(sent[150]);
  EXPECT_EQ(pair.heard_down.size(), 4u);
}

TEST(SealClient, TheEndOfTheKeysIsClear) {
  SealPair pair(key_of(), {}, {.sealed = 3, .dropped = 5});
  pair.run();
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(pair.say_up("x"));
  const auto more = pair.client.seal(bytes_of("x"));
  ASSERT_FALSE(more);
  EXPECT_STREQ(more.error().rule, "R-SEA-4");
  EXPECT_FALSE(pair.client.is_open());
  EXPECT_TRUE(pair.client.handle_timeout(pair.now + 20'000'000));

  SealPair attacked(key_of(), {}, {.dropped = 5});
  attacked.run();
  attacked.say_up("x");
  Bytes forged = attacked.sealed_down("x");
  forged.back() ^= 1u;
  for (int i = 0; i < 4; ++i) attacked.down(forged);
  EXPECT_EQ(attacked.error, "");
  attacked.down(forged);
  EXPECT_EQ(attacked.error, "R-SEA-4");
}

TEST(SealClient, BothEndsTakeLeave) {
  SealPair pair;
  pair.run();
  pair.say_up("x");
  pair.client.close();
  EXPECT_FALSE(pair.client.is_open());
  EXPECT_FALSE(pair.say_up("too late"));
  pair.flow();
  EXPECT_EQ(pair.server.peers(), 0u);
  EXPECT_EQ(pair.server.poll_closed(), pair.peer);

  SealPair other;
  other.run();
  other.server.close();
  other.drain();
  EXPECT_EQ(other.error, "R-SEA-3");
  EXPECT_FALSE(other.say_up("nobody is there"));
}

}  // namespace
}  // namespace tactus
