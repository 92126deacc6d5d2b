// SPDX-License-Identifier: Apache-2.0
/// Both ends of an epoch, and scenes whose packets go between them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <tactus/deformable/deformable_encoder.h>
#include <tactus/rigid/rigid_syntax.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/session/exchange.h>
#include "tests/unit/deformable_fixture.h"

namespace tactus::testing {

using Bytes = std::vector<std::uint8_t>;
inline constexpr std::uint64_t kEpoch = 7, kMillisecond = 1000;

/// Of the parts of a datagram.
inline std::vector<std::size_t> types_of(const Bytes& bytes, Direction direction = Direction::down) {
  const auto read = read_datagram(bytes, direction).value();
  PartReader parts = std::get<Numbered>(read).parts(direction);
  std::vector<std::size_t> out;
  while (const auto part = parts.next().value()) out.push_back(part->index() + 1);
  return out;
}

inline constexpr std::size_t kIsClock = 2, kIsFragment = 7, kIsPacket = 8;

struct Meshes {
  Baseline baseline = Baseline::acknowledged;  // of the packets down
  std::uint32_t squares = 4;
  std::size_t count = 0;
  bool layered = false;
  double noise = 5e-4;        // [m]
  std::uint64_t playout = 0;  // [us] that the client has fixed; 0: none
};

/// A server's end that sends the packets of a scene at 100 ticks per second, and a client's end.
struct Ends {
  explicit Ends(const Meshes& meshes = {}, std::size_t objects = 3) : mesh(sheet(meshes.squares, meshes.squares)) {
    SceneBuilder builder(100);
    for (std::size_t i = 0; i < objects; ++i) {
      builder.rigid("body " + std::to_string(i));
      motions.emplace_back(i + 1);
    }
    for (std::size_t i = 0; i < meshes.count; ++i) {
      builder.deformable("sheet " + std::to_string(i), mesh, {.layered = meshes.layered});
      sheets.emplace_back(mesh, meshes.squares, meshes.noise);
    }
    scene = builder.baselines(64).build().value();
    SenderOptions options;
    options.triggers.reduction = Reduction::none;  // a packet of the bodies in every tick
    options.policy = {.key_interval = 0, .baseline = meshes.baseline};
    server->set_playout(meshes.playout);
    server->send_with(Sender::create(scene, options).value(), meshes.baseline == Baseline::repaired);
    client->receive_with(Receiver::create(scene, {.replica = {.interpolation = Interpolation::playout}}).value());
    if (meshes.baseline != Baseline::repaired) client->expect(false);
    samples.resize(objects);
  }

  /// Code the next tick.
  std::span<const Packet> submit() {
    for (std::size_t i = 0; i < motions.size(); ++i) samples[i] = motions[i].step(1e-2);
    frames.clear();
    shapes.clear();
    for (DentedSheet& sheet : sheets) frames.push_back(sheet.frame(tick));
    for (const SheetFrame& frame : frames) shapes.push_back(frame.truth());
    const auto packets = server->submit(now, tick++, {.objects = samples, .contacts = {}, .deformables = shapes});
    EXPECT_TRUE(packets) << packets.error().rule;
    return packets.value_or(std::span<const Packet>());
  }
  /// The datagrams that an end has now.
  std::vector<Bytes> drain(Exchange& from, bool wanted = false) const {
    std::vector<Bytes> out;
    const auto extras = [wanted](DatagramWriter& writer, std::uint64_t) {
      if (wanted) writer.add(ClockPart{1});
      return false;
    };
    while (const auto datagram = from.poll(now, wanted && out.empty(), extras))
      out.emplace_back(datagram->begin(), datagram->end());
    return out;
  }
  Result<Exchange::Heard> hear(Exchange& to, const Bytes& bytes) {
    const Direction direction = &to == client.get() ? Direction::down : Direction::up;
    EXPECT_TRUE(is_of_epoch(bytes, kEpoch, direction));
    const auto read = read_datagram(bytes, direction);
    EXPECT_TRUE(read) << read.error().rule;
    if (!read) return tl::unexpected(read.error());
    return to.handle(now, std::get<Numbered>(*read), [&](const Part& part, const auto&) {
      others.push_back(part.index() + 1);
      return other;
    });
  }
  void give(const std::vector<Bytes>& datagrams) {
    for (const Bytes& bytes : datagrams) EXPECT_TRUE(hear(*client, bytes));
  }
  /// The client sends what it has, and the server hears it.
  void answer() {
    now += 10 * kMillisecond;
    for (const Bytes& bytes : drain(*client)) EXPECT_TRUE(hear(*server, bytes));
  }
  void expect_same() {
    for (std::size_t s = 0; s <= sheets.size(); ++s)
      EXPECT_EQ(client->receiver->state_hash(s), server->sender->state_hash(s)) << "substream " << s << " at tick " << tick;
  }

  TriMesh mesh;
  SharedScene scene;
  std::vector<Motion> motions;
  std::vector<DentedSheet> sheets;
  std::vector<RigidSample> samples;
  std::vector<SheetFrame> frames;
  std::vector<DeformableTruth> shapes;
  std::uint64_t now = 5'000'000;
  std::int64_t tick = 0;
  std::unique_ptr<Exchange> server = std::make_unique<Exchange>(Direction::down, kEpoch, now);
  std::unique_ptr<Exchange> client = std::make_unique<Exchange>(Direction::up, kEpoch, now);
  std::vector<std::size_t> others;  // types of the parts that an end handed on
  Result<void> other;               // what is sent to them
};

}  // namespace tactus::testing
