// SPDX-License-Identifier: Apache-2.0
/// Two ends of a session over a link that loses, delays and repeats.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/session/exchange.h>
#include "tests/unit/session_exchange_fixture.h"

namespace tactus {
namespace {

using testing::Bytes;
using testing::Ends;
using testing::kEpoch;
using testing::kIsClock;
using testing::kIsPacket;
using testing::kMillisecond;
using testing::Meshes;
using testing::types_of;

TEST(Exchange, PacketsGoAreDecodedAndAcknowledged) {
  Ends ends;
  ends.submit();
  const auto down = ends.drain(*ends.server);
  ASSERT_EQ(down.size(), 1u);
  EXPECT_EQ(std::get<Numbered>(read_datagram(down[0], Direction::down).value()).number, 1);
  ends.now += 20 * kMillisecond;
  const auto heard = ends.hear(*ends.client, down[0]);
  ASSERT_TRUE(heard);
  EXPECT_EQ(heard->number, 1u);
  EXPECT_EQ(heard->tick, 0);
  ends.expect_same();
  EXPECT_TRUE(ends.drain(*ends.client).empty()) << "an acknowledgement waits for something to ride on";
  EXPECT_EQ(ends.client->due(), ends.now + 10 * kMillisecond);
  ends.now += 10 * kMillisecond;
  const auto up = ends.drain(*ends.client);
  ASSERT_EQ(up.size(), 1u);
  EXPECT_EQ(types_of(up[0], Direction::up), std::vector<std::size_t>{1});
  ends.now += 20 * kMillisecond;
  const auto back = ends.hear(*ends.server, up[0]);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->round_trip, 40'000) << "without the 10 ms that it was held";
  EXPECT_EQ(ends.server->sent().highest_acknowledged(), 1u);
  EXPECT_EQ(ends.server->due(), std::nullopt) << "an acknowledgement is not acknowledged";
}

TEST(Exchange, OldAndDoubledDatagramsAreRefused) {
  Ends ends;
  std::vector<Bytes> all;
  for (int i = 0; i < 20; ++i) {
    ends.submit();
    for (const Bytes& bytes : ends.drain(*ends.server)) all.push_back(bytes);
  }
  ASSERT_EQ(all.size(), 20u);
  for (std::size_t i = 2; i < 20; i += 2) std::swap(all[i - 1], all[i]);  // each comes before an older one
  ends.give(all);
  const Traffic before = ends.client->traffic();
  for (const Bytes& bytes : all) {
    const auto heard = ends.hear(*ends.client, bytes);
    ASSERT_FALSE(heard);
    EXPECT_STREQ(heard.error().rule, "R-SES-4");
    EXPECT_EQ(heard.error().code, Errc::state);
  }
  EXPECT_EQ(ends.client->traffic().packets_heard, before.packets_heard);
  EXPECT_EQ(before.packets_heard, all.size()) << "all were decoded";
}

TEST(Exchange, WhatIsRefusedIsNotAcknowledged) {
  Ends ends;
  DatagramWriter writer(Direction::down);
  const Bytes nonsense(30, 0xff);
  for (std::uint64_t number = 1; number <= 3; ++number) {
    writer.begin(number);
    ASSERT_TRUE(writer.add(PacketPart{number == 2 ? 0u : 10u, nonsense}));  // of a number below 1, too
    const auto bytes = writer.finish(kEpoch);
    EXPECT_TRUE(ends.hear(*ends.client, Bytes(bytes.begin(), bytes.end())));
  }
  EXPECT_EQ(ends.client->traffic().packets_heard, 0u);
  EXPECT_EQ(ends.client->due(), std::nullopt);
  ends.now += 1'000'000;
  EXPECT_TRUE(ends.drain(*ends.client).empty());

  Ends deaf;  // whose client cannot decode anything yet
  deaf.client->receiver.reset();
  deaf.submit();
  deaf.give(deaf.drain(*deaf.server));
  EXPECT_EQ(deaf.client->traffic().packets_refused, 1u);
  EXPECT_EQ(deaf.client->due(), std::nullopt);
}

TEST(Exchange, SeveralPacketsShareADatagram) {
  Ends ends({.count = 3});
  EXPECT_EQ(ends.submit().size(), 4u);
  const auto down = ends.drain(*ends.server);
  ASSERT_EQ(down.size(), 1u);
  EXPECT_EQ(types_of(down[0]), (std::vector<std::size_t>{kIsPacket, kIsPacket, kIsPacket, kIsPacket}));
  ends.give(down);
  ends.expect_same();
  ends.answer();
  EXPECT_EQ(ends.server->sent().highest_acknowledged(), 1u);
}

TEST(Exchange, OneRefusedPacketLeavesItsDatagramUnacknowledged) {
  Ends ends({.count = 3});
  ends.submit();
  const Bytes whole = ends.drain(*ends.server)[0];
  const auto read = read_datagram(whole, Direction::down).value();
  PartReader parts = std::get<Numbered>(read).parts(Direction::down);
  DatagramWriter writer(Direction::down);
  writer.begin(1);
  const Bytes nonsense(30, 0xff);
  for (int i = 0; const auto part = parts.next().value(); ++i)
    ASSERT_TRUE(writer.add(i == 1 ? Part(PacketPart{0, nonsense}) : *part));
  const auto bytes = writer.finish(kEpoch);
  EXPECT_TRUE(ends.hear(*ends.client, Bytes(bytes.begin(), bytes.end())));
  EXPECT_EQ(ends.client->traffic().packets_refused, 1u);
  EXPECT_EQ(ends.client->traffic().packets_heard, 3u) << "the others count";
  EXPECT_EQ(ends.client->due(), std::nullopt);
}

/// The layers of a mesh build on each other: the second has the next number, and goes in the next datagram.
TEST(Exchange, TheSecondLayerOfAMeshHasTheNextNumber) {
  Ends ends({.squares = 12, .count = 2, .layered = true});
  std::uint64_t number = 0, visual = 0;
  for (int i = 0; i < 200; ++i) {
    const auto packets = ends.submit();
    for (const Packet& packet : packets) {
      EXPECT_GE(packet.number, number + 1);
      EXPECT_LE(packet.number, number + 2);
      visual += packet.layer == Layer::visual ? 1u : 0u;
    }
    const auto down = ends.drain(*ends.server);
    number += down.size();
    ends.give(down);
    if (i % 2 == 0) ends.answer();
    ends.expect_same();
  }
  EXPECT_GT(visual, 50u);
  EXPECT_EQ(ends.client->traffic().packets_refused, 0u);
}

TEST(Exchange, ALostLayerIsMadeUpFor) {
  Ends ends({.squares = 12, .count = 1, .layered = true});
  std::mt19937_64 random(6);
  std::uint64_t dropped = 0;
  for (int i = 0; i < 600; ++i) {
    ends.submit();
    for (const Bytes& bytes : ends.drain(*ends.server)) {
      if (i < 500 && random() % 10 == 0) ++dropped;
      else EXPECT_TRUE(ends.hear(*ends.client, bytes));
    }
    ends.answer();
  }
  EXPECT_GT(dropped, 20u);
  ends.expect_same();
  EXPECT_GT(ends.client->traffic().packets_heard, 400u);
}

/// Packets of a tick that nobody fetched, or some of them: the states stay the same, now and later.
TEST(Exchange, PacketsThatAreNotTakenDoNoHarm) {
  for (const bool layered : {false, true}) {
    for (const std::size_t taken : {0u, 1u}) {
      Ends ends({.squares = 12, .count = 2, .layered = layered});
      std::mt19937_64 random(9);
      for (int i = 0; i < 400; ++i) {
        ends.submit();
        const auto extras = [](DatagramWriter&, std::uint64_t) { return false; };
        if (i < 300 && random() % 4 == 0) {
          for (std::size_t n = 0; n < taken; ++n) {
            const auto datagram = ends.server->poll(ends.now, false, extras);
            if (datagram) ends.give({Bytes(datagram->begin(), datagram->end())});
          }
          continue;
        }
        ends.give(ends.drain(*ends.server));
        ends.answer();
        if (!layered && ends.server->sender->state_hash(0) != ends.client->receiver->state_hash(0)) {
          ADD_FAILURE() << "other states at tick " << ends.tick << ", " << taken << " taken";
          break;
        }
      }
      ends.expect_same();
      EXPECT_TRUE(taken > 0 || ends.server->traffic().packets_held > 30u);
      if (!layered) {
        EXPECT_EQ(ends.client->traffic().packets_refused, 0u);
      }
    }
  }
}

TEST(Exchange, APacketThatIsTooLargeIsLeftOut) {
  constexpr std::uint32_t kSquares = 380;
  const TriMesh mesh = testing::sheet(kSquares, kSquares);
  DeformableOptions exact;
  exact.thresholds = {.visual = 0, .weber_fraction = {}};
  Ends ends({}, 0);
  const SharedScene scene = SceneBuilder(100).deformable("sheet", mesh).baselines(2).build().value();
  ends.server->sender.emplace(Sender::create(scene, {.triggers = {}, .deformable = exact, .policy = {}}).value());
  std::vector<float> far(3 * mesh.vertices.size());
  std::mt19937_64 random(1);
  std::uniform_real_distribution<float> metres(-25, 25);
  for (float& u : far) u = metres(random);
  const DeformableTruth truth{far, {}};
  const auto packets = ends.server->submit(ends.now, 0, {.objects = {}, .contacts = {}, .deformables = {&truth, 1}});
  ASSERT_TRUE(packets) << packets.error().rule;
  ASSERT_EQ(packets->size(), 1u);
  ASSERT_GT((*packets)[0].bytes.size(), kFragmentSize * kMostFragments);
  int datagrams = 0;
  while (const auto datagram = ends.server->poll(ends.now, false, [](DatagramWriter&, std::uint64_t) { return false; })) {
    EXPECT_TRUE(read_datagram(*datagram, Direction::down)) << "a datagram of " << datagram->size() << " bytes";
    ++datagrams;
  }
  EXPECT_EQ(datagrams, 0);
  EXPECT_EQ(ends.server->traffic().packets_held, 1u);
}

TEST(Exchange, WithoutAcknowledgementsItSendsLittle) {
  Ends ends;
  const auto datagrams = [&](int ticks, bool answers) {
    std::size_t count = 0;
    for (int i = 0; i < ticks; ++i) {
      ends.submit();
      const auto down = ends.drain(*ends.server);
      count += down.size();
      if (answers) {
        ends.give(down);
        ends.answer();
      } else {
        ends.now += 10 * kMillisecond;
      }
    }
    return count;
  };
  EXPECT_GT(datagrams(200, true), 100u);
  EXPECT_EQ(ends.server->traffic().ticks_held, 0u);
  datagrams(110, false);  // it waits for a second at least
  const std::size_t silent = datagrams(1000, false);
  EXPECT_LE(silent, 201u) << "20 in a second";
  EXPECT_GE(silent, 100u) << "so that the end is found again";
  EXPECT_GT(ends.server->traffic().ticks_held, 500u);
  datagrams(20, true);
  const std::uint64_t held = ends.server->traffic().ticks_held;
  EXPECT_GT(datagrams(100, true), 50u);
  EXPECT_EQ(ends.server->traffic().ticks_held, held);
  ends.expect_same();
}

TEST(Exchange, WhenTooManyNumbersWaitItIsSilent) {
  Ends ends;
  std::size_t datagrams = 0;
  for (int i = 0; i < 60'000; ++i) {
    ends.submit();
    datagrams += ends.drain(*ends.server).size();
    ends.now += 50 * kMillisecond;
  }
  EXPECT_EQ(datagrams, SentNumbers::kMostAhead);
  EXPECT_TRUE(ends.drain(*ends.server, true).empty());
}

TEST(Exchange, OtherPartsAreHandedOn) {
  Ends ends;
  DatagramWriter writer(Direction::up);
  const auto send = [&](std::uint64_t number) {
    writer.begin(number);
    EXPECT_TRUE(writer.add(ButtonsPart{1, 2}) && writer.add(StatePart{1}) && writer.add(HashPart{}));
    const auto bytes = writer.finish(kEpoch);
    return ends.hear(*ends.server, Bytes(bytes.begin(), bytes.end()));
  };
  EXPECT_TRUE(send(1));
  EXPECT_EQ(ends.others, (std::vector<std::size_t>{3, 5, 6}));
  EXPECT_TRUE(ends.server->due()) << "they must be acknowledged";
  ends.other = fail(Errc::invalid, "R-SES-8");
  const auto refused = send(2);
  ASSERT_FALSE(refused);
  EXPECT_STREQ(refused.error().rule, "R-SES-8");
  EXPECT_EQ(ends.others.size(), 4u) << "nothing after the part that was refused";
}

TEST(Exchange, AClockAloneIsNotAcknowledged) {
  Ends ends;
  ends.give(ends.drain(*ends.server, true));
  EXPECT_EQ(ends.others, std::vector<std::size_t>{kIsClock});
  EXPECT_EQ(ends.client->due(), std::nullopt);
}

TEST(Exchange, AcknowledgementsOfWhatWasNeverSentAreRefused) {
  Ends ends;
  DatagramWriter writer(Direction::up);
  writer.begin(1);
  ASSERT_TRUE(writer.add(Acknowledgement{5, 0, 0}));
  const auto bytes = writer.finish(kEpoch);
  const auto heard = ends.hear(*ends.server, Bytes(bytes.begin(), bytes.end()));
  ASSERT_FALSE(heard);
  EXPECT_STREQ(heard.error().rule, "R-SES-6");
}

/// Which ticks of a mesh the client gets, if each ninth datagram is lost.   in   trip  [ms]
std::pair<std::set<std::int64_t>, std::set<std::int64_t>> shapes_over(std::uint64_t trip, bool layered) {
  Ends ends({.squares = 4, .count = 1, .layered = layered}, 0);
  std::set<std::int64_t> made, got;
  std::multimap<std::uint64_t, Bytes> down, up;
  std::size_t datagrams = 0;
  for (int i = 0; i < 6000; ++i) {
    ends.now += kMillisecond;
    if (i % 10 == 0 && i < 5500 && !ends.submit().empty()) made.insert(ends.tick - 1);
    for (Bytes& bytes : ends.drain(*ends.server))
      if (++datagrams % 9 > 0) down.emplace(ends.now + trip * kMillisecond / 2, std::move(bytes));
    for (; !down.empty() && down.begin()->first <= ends.now; down.erase(down.begin())) {
      const auto heard = ends.hear(*ends.client, down.begin()->second);
      if (heard && heard->tick) got.insert({*heard->tick, *heard->oldest});
    }
    for (Bytes& bytes : ends.drain(*ends.client)) up.emplace(ends.now + trip * kMillisecond / 2, std::move(bytes));
    for (; !up.empty() && up.begin()->first <= ends.now; up.erase(up.begin()))
      EXPECT_TRUE(ends.hear(*ends.server, up.begin()->second));
  }
  return {made, got};
}

TEST(Exchange, LostShapesComeAgainWhereTheDelayIsShort) {
  const auto missing = [](std::uint64_t trip, bool layered) {
    const auto [made, got] = shapes_over(trip, layered);
    EXPECT_GT(made.size(), 300u);
    std::size_t out = 0;
    for (const std::int64_t tick : made) out += got.contains(tick) ? 0u : 1u;
    return static_cast<double>(out) / static_cast<double>(made.size());
  };
  EXPECT_LT(missing(10, false), 0.02);
  EXPECT_LT(missing(40, false), 0.02);
  EXPECT_GT(missing(120, false), 0.08) << "it would be too late";
  EXPECT_GT(missing(40, true), 0.08) << "layers build on each other";
}

TEST(Exchange, EachSixtyFourthPacketIsHashed) {
  Ends ends;
  std::set<std::uint16_t> hashed;
  for (int i = 0; i < 400; ++i) {
    ends.submit();
    for (const Bytes& bytes : ends.drain(*ends.server)) {
      const auto heard = ends.hear(*ends.client, bytes);
      ASSERT_TRUE(heard);
      if (!heard->hash) continue;
      EXPECT_EQ(heard->hash->hash, static_cast<std::uint32_t>(ends.server->sender->state_hash(0)));
      EXPECT_EQ(heard->hash->number % 64, 0);
      hashed.insert(heard->hash->number);
    }
    ends.answer();
  }
  EXPECT_GE(hashed.size(), 3u);
}

/// A client's end for single packets of one object.
struct Alone {
  explicit Alone(std::uint8_t dof = Dof::all) {
    const SharedScene scene = SceneBuilder(1000).rigid("object", {}, {.dof = dof}).baselines(64).build().value();
    client.receive_with(Receiver::create(scene, {.replica = {.interpolation = Interpolation::playout}}).value());
  }
  Exchange::Heard hear(std::uint64_t number, const Bytes& packet) {
    DatagramWriter writer(Direction::down);
    writer.begin(number);
    EXPECT_TRUE(writer.add(PacketPart{0, packet}));
    const auto bytes = writer.finish(kEpoch);
    const auto read = read_datagram(bytes, Direction::down).value();
    return client.handle(0, std::get<Numbered>(read), [](const Part&, const auto&) { return Result<void>(); }).value();
  }
  Exchange client{Direction::up, kEpoch, 0};
};

TEST(Exchange, AReorderedPacketIsNotHashedThoughItIsOfTheSameTick) {
  Alone alone;
  alone.hear(60, {0xfa, 0xb7, 0x82, 0xeb, 0xe4, 0xc0});
  alone.hear(66, {0x37, 0x37, 0x30, 0xf6, 0xc0, 0xce, 0x84, 0xba});  // both build on 60, at tick 10
  EXPECT_FALSE(alone.hear(64, {0x2f, 0x61, 0x70, 0xf6, 0xc0, 0xa2, 0xb4}).hash);
  EXPECT_EQ(alone.client.traffic().packets_heard, 3u);
}

TEST(Exchange, PacketsOfASceneInWhichNothingMovesAreHeldToo) {
  Alone alone(0);
  alone.hear(3, {0xfa, 0xb7, 0x82, 0xeb, 0xe4, 0xc0});  // a key packet: it names an object that does not move
  EXPECT_FALSE(alone.client.due());
  alone.hear(5, {0x10, 0x22, 0x1f, 0xb8, 0x7f, 0xce, 0x60});  // builds on 4
  EXPECT_TRUE(alone.client.due()) << "held, and so acknowledged";
}

/// A tick of a mesh in layers takes two numbers. When the last number that may go without an acknowledgement takes the first, the second is
/// nobody's, and the next packet must have another one.
TEST(Exchange, TheWindowMayEndBetweenTwoPacketsOfATick) {
  bool ended_between = false;
  for (int phase = 1; phase < 7; ++phase) {
    Ends ends({.squares = 44, .count = 1, .layered = true, .noise = 3e-3}, 1);
    const auto submit = [&] {
      ends.now += 1000;
      for (std::size_t i = 0; i < ends.motions.size(); ++i) ends.samples[i] = ends.motions[i].step(1e-2);
      ends.frames.clear();
      ends.shapes.clear();
      for (auto& sheet : ends.sheets) ends.frames.push_back(sheet.frame(ends.tick));
      for (auto& frame : ends.frames) ends.shapes.push_back(frame.truth());
      return ends.server->submit(ends.now, ends.tick++, {.objects = ends.samples, .contacts = {}, .deformables = ends.shapes});
    };
    const auto go = [&] {
      for (const Bytes& bytes : ends.drain(*ends.server)) static_cast<void>(ends.hear(*ends.client, bytes));
      ends.answer();
    };
    for (int i = 0; i < 20; ++i) {
      ASSERT_TRUE(submit());
      go();
    }
    for (int i = 0; i < phase; ++i) static_cast<void>(ends.drain(*ends.server, true));
    std::uint64_t highest = 0;
    std::optional<Bytes> first;  // of those that are lost
    for (int silent = 0; silent <= 20;) {
      const auto packets = submit();
      ASSERT_TRUE(packets);
      silent = packets->empty() ? silent + 1 : 0;
      if (!packets->empty()) highest = packets->back().number;
      for (const Bytes& bytes : ends.drain(*ends.server))
        if (!first) first = bytes;
    }
    ended_between = ended_between || highest > ends.server->sent().newest();
    static_cast<void>(ends.hear(*ends.client, *first));  // it comes after all
    ends.answer();
    ends.answer();
    for (int i = 0; i < 50; ++i) {
      ends.now += 60'000;
      ASSERT_TRUE(submit()) << phase;
      go();
    }
  }
  EXPECT_TRUE(ended_between);
}

TEST(Exchange, APacketFromBeforeTheFirstNumberIsCountedAsRefused) {
  Ends ends;
  DatagramWriter writer(Direction::down);
  writer.begin(1);
  const Bytes packet(10, 1);
  ASSERT_TRUE(writer.add(PacketPart{5, packet}));
  const auto bytes = writer.finish(kEpoch);
  static_cast<void>(ends.hear(*ends.client, Bytes(bytes.begin(), bytes.end())));
  EXPECT_EQ(ends.client->traffic().packets_refused, 1u);
  EXPECT_EQ(ends.client->due(), std::nullopt) << "nor is it acknowledged";
}

}  // namespace
}  // namespace tactus
