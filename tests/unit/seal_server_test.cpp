// SPDX-License-Identifier: Apache-2.0
/// Strangers, floods and many clients at the server's end of the seal.
#include <tactus/seal/seal_server.h>

#include <malloc.h>

#include <algorithm>
#include <random>

#include <tactus/net/rate_limit.h>
#include "tests/property/allocated.h"
#include "tests/unit/seal_fixture.h"

namespace tactus {
namespace {

using testing::address;
using testing::Bytes;
using testing::bytes_of;
using testing::key_of;
using testing::SealPair;

/// The datagrams that a client sends until it is open.
std::vector<Bytes> flights() {
  SealPair pair;
  std::vector<Bytes> out;
  pair.network_up = [&out](const Bytes& datagram) {
    out.push_back(datagram);
    return std::vector<Bytes>{datagram};
  };
  pair.run();
  pair.say_up("data");
  return out;
}

net::Address stranger(unsigned number) {
  return address("198.51.100." + std::to_string(number % 250 + 1) + ":" + std::to_string(1000 + number % 60'000));
}

TEST(SealServer, AStrangerGetsACookieAndNothingElse) {
  const auto flight = flights();
  ASSERT_EQ(flight.size(), 4u);  // hello, hello with cookie, keys, data
  SealPair pair;
  for (std::size_t i = 0; i < flight.size(); ++i) {
    const net::Address from = stranger(static_cast<unsigned>(i));
    EXPECT_FALSE(pair.server.open(pair.now, from, flight[i]));
    const auto answer = pair.server.poll_datagram();
    EXPECT_EQ(answer.has_value(), i < 2) << i;  // the cookie of another address is none
    if (answer) {
      EXPECT_EQ(answer->to, from);
      EXPECT_EQ(answer->bytes.size(), 44u);
    }
    EXPECT_FALSE(pair.server.poll_datagram());
    EXPECT_FALSE(pair.server.has_work());
  }
  EXPECT_EQ(pair.server.handshakes(), 0u);
  EXPECT_EQ(pair.server.counters().cookies, 2u);
  EXPECT_EQ(pair.server.counters().strangers, 2u);
}

/// What is remembered of strangers: nothing, whatever they send.
TEST(SealServer, AHundredThousandDatagramsOfStrangersLeaveNothing) {
  const auto flight = flights();
  SealPair pair;
  pair.run();
  std::mt19937 random(1);
  std::uint64_t heard = 0, answered = 0;
  const auto flood = [&](unsigned count) {
    for (unsigned i = 0; i < count; ++i) {
      Bytes datagram;
      if (random() % 4 == 0) {
        datagram.resize(random() % 1400);
        for (auto& byte : datagram) byte = static_cast<std::uint8_t>(random());
        if (random() % 2 == 0 && datagram.size() > 13) {  // a head that promises something
          const std::uint8_t head[]{static_cast<std::uint8_t>(20 + random() % 4), 0xFE, 0xFD, 0,
                                    static_cast<std::uint8_t>(random() % 2)};
          std::copy(std::begin(head), std::end(head), datagram.begin());
          datagram[11] = static_cast<std::uint8_t>((datagram.size() - 13) >> 8);
          datagram[12] = static_cast<std::uint8_t>(datagram.size() - 13);
        }
      } else {
        datagram = flight[random() % flight.size()];
        for (unsigned k = random() % 4; k > 0; --k) datagram[random() % datagram.size()] = static_cast<std::uint8_t>(random());
        if (random() % 8 == 0) datagram.resize(random() % (2 * datagram.size()));
      }
      const net::Address from = stranger(static_cast<unsigned>(random()));
      EXPECT_FALSE(pair.server.open(pair.now, from, datagram));
      std::size_t sent_back = 0;
      while (const auto answer = pair.server.poll_datagram()) {
        EXPECT_EQ(answer->to, from);
        sent_back += answer->bytes.size();
      }
      ASSERT_LE(sent_back, 3 * datagram.size());
      heard += datagram.size();
      answered += sent_back;
      pair.now += 100;
      if (i % 10 == 0) pair.server.work(pair.now);
    }
  };
  flood(10'000);
  const std::uint64_t blocks = testing::live_blocks();
  const std::size_t bytes = mallinfo2().uordblks;
  flood(100'000);
  EXPECT_EQ(testing::live_blocks(), blocks);
  EXPECT_LE(mallinfo2().uordblks, bytes + 4096) << "of which GnuTLS too";
  EXPECT_EQ(pair.server.peers(), 1u);
  EXPECT_EQ(pair.server.handshakes(), 0u);
  EXPECT_LT(answered, heard);
  EXPECT_GT(pair.server.counters().limited, 40'000u) << "beyond 5000 per second nothing is done for strangers";
  EXPECT_TRUE(pair.say_up("still there"));
  EXPECT_EQ(pair.heard_up.size(), 1u);
}

/// The same from the address of a client that is there: as an attacker would who forges its address.
TEST(SealServer, ForgedDatagramsOfAClientEndNothing) {
  const auto flight = flights();
  SealPair pair;
  pair.run();
  std::mt19937 random(2);
  for (unsigned i = 0; i < 50'000; ++i) {
    Bytes datagram = flight[random() % flight.size()];
    for (unsigned k = random() % 4; k > 0; --k) datagram[random() % datagram.size()] = static_cast<std::uint8_t>(random());
    if (random() % 4 == 0) datagram[4] = 1;  // the epoch of sealed records
    std::size_t sent_back = 0;
    EXPECT_FALSE(pair.server.open(pair.now, pair.at, datagram));
    while (const auto answer = pair.server.poll_datagram()) sent_back += answer->bytes.size();
    ASSERT_LE(sent_back, 3 * datagram.size());
    pair.server.work(pair.now += 200);  // as many as a client may send
  }
  EXPECT_EQ(pair.server.counters().limited, 0u);
  EXPECT_EQ(pair.server.peers(), 1u);
  EXPECT_FALSE(pair.server.poll_closed());
  EXPECT_TRUE(pair.say_up("still there"));
  EXPECT_EQ(pair.heard_up.size(), 1u);
}

TEST(SealServer, EveryFirstDatagramGetsLittle) {
  const auto flight = flights();
  SealPair pair;
  for (const Bytes& whole : flight) {
    for (std::size_t size = 0; size <= whole.size(); ++size) {
      Bytes datagram(whole.begin(), whole.begin() + static_cast<long>(size));
      if (size >= 13) {
        datagram[11] = static_cast<std::uint8_t>((size - 13) >> 8);
        datagram[12] = static_cast<std::uint8_t>(size - 13);
      }
      static_cast<void>(pair.server.open(pair.now, stranger(7), datagram));
      if (const auto answer = pair.server.poll_datagram()) {
        EXPECT_LT(answer->bytes.size(), size);
      }
    }
  }
  EXPECT_GT(pair.server.counters().cookies, 0u);
  EXPECT_EQ(pair.server.handshakes(), 0u);
}

/// Clients with addresses of their own, and one server.
struct Crowd {
  explicit Crowd(std::size_t count, const seal::ServerOptions& options, bool have_key = true)
      : server(seal::Server::create(key_of(), now, options).value()) {
    for (std::size_t i = 0; i < count; ++i) add(have_key);
  }
  void add(bool has_key = true) {
    clients.push_back(
        std::make_unique<seal::Client>(seal::Client::create(has_key ? key_of() : key_of("lab", "00"), now).value()));
  }
  net::Address at(std::size_t i) const { return address("203.0.113." + std::to_string(i + 1) + ":4000"); }
  void run(std::uint64_t time) {
    for (const std::uint64_t end = now + time; now < end; now += 1000) {
      for (std::size_t i = 0; i < clients.size(); ++i) {
        static_cast<void>(clients[i]->handle_timeout(now));
        while (const auto datagram = clients[i]->poll_datagram()) {
          static_cast<void>(server.open(now, at(i), bytes_of(*datagram)));
          drain();
        }
      }
      server.work(now);
      most_handshakes = std::max(most_handshakes, server.handshakes());
      drain();
    }
  }
  void drain() {
    while (const auto datagram = server.poll_datagram())
      for (std::size_t i = 0; i < clients.size(); ++i)
        if (datagram->to == at(i)) static_cast<void>(clients[i]->open(now, bytes_of(datagram->bytes)));
  }
  std::size_t open() const {
    return static_cast<std::size_t>(std::ranges::count_if(clients, [](const auto& client) { return client->is_open(); }));
  }
  std::uint64_t now = 1'000'000;
  seal::Server server;
  std::vector<std::unique_ptr<seal::Client>> clients;
  std::size_t most_handshakes = 0;
};

/// A client with a key sends 50 000 datagrams per second, one host without as many ClientHellos from its ports, and forged hosts, too: whoever
/// is there is heard as without them, and who comes comes in.
TEST(SealServer, FloodsReachNobodyElse) {
  const Bytes hello = flights().front();
  Crowd crowd(3, {});
  crowd.run(100'000);
  ASSERT_EQ(crowd.open(), 3u);
  crowd.add();
  std::uint64_t heard = 0, sent = 0, flooded = 0;
  const std::uint64_t began = crowd.now, cookies = crowd.server.counters().cookies;
  constexpr std::uint64_t kSeconds = 4;
  for (std::uint64_t tick = 0; tick < kSeconds * 1000; ++tick) {
    for (std::size_t i = 0; i < 2; ++i, ++sent) {
      const auto opened = crowd.server.open(crowd.now, crowd.at(i), bytes_of(crowd.clients[i]->seal(bytes_of("true")).value()));
      heard += opened && opened->peer == i + 1 ? 1u : 0u;
    }
    for (unsigned i = 0; i < 50; ++i) {
      const auto forged = static_cast<unsigned>(50 * tick + i);
      flooded += crowd.server.open(crowd.now, crowd.at(2), bytes_of(crowd.clients[2]->seal(bytes_of("much")).value())) ? 1u : 0u;
      static_cast<void>(crowd.server.open(crowd.now, address("198.51.100.9:" + std::to_string(1 + forged % 60'000)), hello));
      if (i % 25 == 0)  // 2000 per second
        static_cast<void>(
            crowd.server.open(crowd.now,
                              address("10." + std::to_string(forged / 65'536) + '.' + std::to_string(forged / 256 % 256) + '.' +
                                      std::to_string(forged % 256) + ":9"),
                              hello));
      crowd.drain();
    }
    crowd.run(1000);
    const bool may_wait = crowd.now - began < 500'000;
    ASSERT_TRUE(may_wait || crowd.clients[3]->is_open()) << tick;
  }
  EXPECT_EQ(heard, sent);
  EXPECT_LE(flooded, (kSeconds + 1) * net::kClientRate.datagrams);
  EXPECT_LE(crowd.server.counters().cookies - cookies, (kSeconds + 1) * net::kStrangersRate.datagrams);
  EXPECT_GT(crowd.server.counters().limited, kSeconds * 80'000);
  EXPECT_GT(crowd.server.limited_of(3), kSeconds * 40'000) << "who it was is known";
  EXPECT_EQ(crowd.server.limited_of(1), 0u);
}

/// Who has validated an address can still make a server compare cookies, but not often; and comes in.
TEST(SealServer, AHandshakeIsFewDatagrams) {
  SealPair pair;
  Bytes with_cookie;
  pair.network_up = [&](const Bytes& datagram) {
    if (pair.server.handshakes() == 0) with_cookie = datagram;
    return pair.server.handshakes() == 0 ? std::vector<Bytes>{datagram} : std::vector<Bytes>{};
  };
  pair.run(10'000);
  ASSERT_EQ(pair.server.handshakes(), 1u);
  for (int i = 0; i < 1000; ++i) static_cast<void>(pair.server.open(pair.now, pair.at, with_cookie));
  EXPECT_GE(pair.server.counters().limited, 800u);
  pair.network_up = [](const Bytes& datagram) { return std::vector<Bytes>{datagram}; };
  pair.run(1'000'000);
  EXPECT_TRUE(pair.client.is_open());
}

TEST(SealServer, ServesManyAtATime) {
  Crowd crowd(20, {.peers = 20});
  crowd.run(200'000);
  EXPECT_EQ(crowd.open(), 20u);
  EXPECT_EQ(crowd.server.peers(), 20u);
  EXPECT_EQ(crowd.server.handshakes(), 0u);
}

TEST(SealServer, WorksOnOneStepOfOneHandshakeAtATime) {
  Crowd crowd(5, {});
  for (std::size_t i = 0; i < 5; ++i) {
    static_cast<void>(crowd.server.open(crowd.now, crowd.at(i), bytes_of(crowd.clients[i]->poll_datagram().value())));
    static_cast<void>(crowd.clients[i]->open(crowd.now, bytes_of(crowd.server.poll_datagram()->bytes)));
    static_cast<void>(crowd.server.open(crowd.now, crowd.at(i), bytes_of(crowd.clients[i]->poll_datagram().value())));
    EXPECT_FALSE(crowd.server.poll_datagram());
  }
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_TRUE(crowd.server.has_work());
    crowd.server.work(crowd.now);
    const auto answer = crowd.server.poll_datagram();
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->to, crowd.at(i)) << "in their order";
    EXPECT_FALSE(crowd.server.poll_datagram());
  }
  EXPECT_FALSE(crowd.server.has_work());
}

TEST(SealServer, HasRoomForSoManyPeers) {
  Crowd crowd(6, {.peers = 4});
  crowd.run(9'000'000);
  EXPECT_EQ(crowd.open(), 4u);
  EXPECT_EQ(crowd.server.peers(), 4u);
}

TEST(SealServer, HandshakesWithoutTheKeyTakeNoSlotForLong) {
  Crowd crowd(10, {.peers = 4, .handshakes = 3}, false);
  crowd.run(1'000'000);
  EXPECT_EQ(crowd.most_handshakes, 3u);
  crowd.add();
  crowd.run(2'000'000);
  EXPECT_TRUE(crowd.clients.back()->is_open()) << "it takes the place of the oldest";
  crowd.clients.clear();
  crowd.run(11'000'000);
  EXPECT_EQ(crowd.server.handshakes(), 0u);
  EXPECT_EQ(crowd.server.peers(), 1u);
}

TEST(SealServer, KeepsWhatIsNeededAndWhatIsNew) {
  Crowd crowd(3, {});
  crowd.run(100'000);
  ASSERT_EQ(crowd.server.peers(), 3u);
  const auto second_only = [](std::uint64_t peer) { return peer == 2; };
  crowd.server.keep_only(crowd.now, second_only);
  EXPECT_EQ(crowd.server.peers(), 3u) << "they may be about to join";
  crowd.now += 11'000'000;
  crowd.server.keep_only(crowd.now, second_only);
  EXPECT_EQ(crowd.server.peers(), 1u);
  EXPECT_EQ(crowd.server.poll_closed(), 3u);
  EXPECT_EQ(crowd.server.poll_closed(), 1u);
  EXPECT_FALSE(crowd.server.poll_closed());
  crowd.drain();
  EXPECT_EQ(crowd.open(), 1u) << "the others got an alert";
  EXPECT_TRUE(crowd.server.seal(2, bytes_of("x")));
  const auto gone = crowd.server.seal(1, bytes_of("x"));
  ASSERT_FALSE(gone);
  EXPECT_STREQ(gone.error().rule, "R-SEA-5");
}

TEST(SealServer, AClientThatBeginsAnewReplacesItself) {
  SealPair pair;
  pair.run();
  pair.say_up("old");
  const std::uint64_t old = pair.peer;
  const Bytes late = pair.sealed_up("late");
  pair.client = seal::Client::create(key_of(), pair.now).value();
  const auto hello = bytes_of(pair.client.poll_datagram().value());
  pair.up(hello);
  pair.up(late);  // the old association works until the new one is there
  EXPECT_EQ(pair.heard_up.size(), 2u);
  pair.run();
  ASSERT_TRUE(pair.client.is_open());
  EXPECT_FALSE(pair.server.poll_closed()) << "the session of the old one may go on";
  EXPECT_EQ(pair.server.address_of(old), net::Address());
  EXPECT_EQ(pair.server.peers(), 1u);
  pair.say_up("new");
  EXPECT_NE(pair.peer, old);
  EXPECT_EQ(pair.heard_up.back(), bytes_of("new"));
}

TEST(SealServer, ReplaysAndForgeriesAreCounted) {
  SealPair pair;
  pair.run();
  const Bytes once = pair.sealed_up("once");
  for (int i = 0; i < 3; ++i) pair.up(once);
  Bytes forged = pair.sealed_up("forged");
  forged[20] ^= 4u;
  pair.up(forged);
  EXPECT_EQ(pair.heard_up.size(), 1u);
  EXPECT_EQ(pair.server.counters().replayed, 2u);
  EXPECT_EQ(pair.server.counters().unauthentic, 1u);
  EXPECT_EQ(pair.server.counters().opened, 1u);
}

TEST(SealServer, TheEndOfTheKeysClosesOneAssociation) {
  SealPair pair(key_of(), {.limits = {.sealed = 2}});
  pair.run();
  pair.say_up("x");
  static_cast<void>(pair.sealed_down("1"));
  static_cast<void>(pair.sealed_down("2"));
  const auto more = pair.server.seal(pair.peer, bytes_of("3"));
  ASSERT_FALSE(more);
  EXPECT_STREQ(more.error().rule, "R-SEA-4");
  EXPECT_EQ(pair.server.poll_closed(), pair.peer);
  EXPECT_EQ(pair.server.peers(), 0u);
}

}  // namespace
}  // namespace tactus
