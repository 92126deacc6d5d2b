// SPDX-License-Identifier: Apache-2.0
/// The decoder's side of the C interface says what the C++ library says.
#include <tactus/deformable/displacement.h>
#include <tactus/player.h>
#include <tactus/scene/scene_syntax.h>

#include <limits>

#include "tests/bindings/fixture.h"

namespace tactus::c_test {
namespace {

Player open(const std::vector<std::uint8_t>& file) {
  tactus_player* raw = nullptr;
  EXPECT_EQ(tactus_player_open(file.data(), file.size(), nullptr, &raw, nullptr), TACTUS_OK);
  return Player(raw);
}

TEST(CDecoder, PlaysAsTheLibraryDoes) {
  const std::vector<std::uint8_t> file = make_stream(true);
  const Player player = open(file);
  tactus_receiver* receiver = tactus_player_receiver(player.get());
  auto expected = tactus::Player::open(file).value();
  std::size_t packets = 0;
  for (std::int64_t tick = 0; tick < 500; ++tick) {
    tactus_packet_info info = sized<tactus_packet_info>();
    while (tactus_player_play(player.get(), tick, &info, nullptr) == TACTUS_OK) {
      const auto played = expected.play(tick).value();
      ASSERT_TRUE(played);
      EXPECT_EQ(info.bytes, played->bytes);
      EXPECT_EQ(info.offset, played->offset);
      EXPECT_EQ(info.tick, played->tick);
      EXPECT_EQ(info.number, played->number);
      EXPECT_EQ(info.substream, played->substream);
      EXPECT_EQ(info.kind, played->substream == 0 ? TACTUS_KIND_RIGID : TACTUS_KIND_DEFORMABLE);
      EXPECT_EQ(info.updates, played->updates.size() + played->vertices);
      ++packets;
    }
    ASSERT_FALSE(expected.play(tick).value());
    tactus_pose poses[2];
    ASSERT_EQ(tactus_receiver_poses(receiver, tick, 0, 2, poses, nullptr, nullptr), TACTUS_OK);
    const Pose shown = expected.pose(1, tick);
    EXPECT_EQ(poses[1].position[0], shown.position.x);
    EXPECT_EQ(poses[1].rotation[0], shown.rotation.w);
    float u[12];
    ASSERT_EQ(tactus_receiver_displacements(receiver, 0, tick, u, 12, nullptr), TACTUS_OK);
    EXPECT_TRUE(std::ranges::equal(u, expected.displacements(0, tick)));
  }
  EXPECT_GT(packets, 10u);
  auto end = sized<tactus_player_info>();
  ASSERT_EQ(tactus_player_get(player.get(), &end, nullptr), TACTUS_OK);
  EXPECT_EQ(end.header_bytes, expected.header_bytes());
  EXPECT_EQ(end.complete, 1u);
  EXPECT_EQ(end.next_tick, INT64_MAX);
  for (std::uint32_t substream = 0; substream < 2; ++substream) {
    std::uint64_t hash = 0;
    ASSERT_EQ(tactus_receiver_hash(receiver, substream, &hash, 0, nullptr, nullptr), TACTUS_OK);
    EXPECT_EQ(hash, expected.receiver().state_hash(substream));
  }
  std::uint64_t hash = 0;
  ASSERT_EQ(tactus_receiver_hash(receiver, 0, nullptr, 500, &hash, nullptr), TACTUS_OK);
  EXPECT_EQ(hash, expected.replica().pose_hash(500));
}

TEST(CDecoder, TheEndOfAFileIsNoError) {
  auto info = sized<tactus_player_info>();
  tactus_error error{};
  const std::vector<std::uint8_t> file = make_stream(false, 0);
  const Player empty = open(file);
  EXPECT_EQ(tactus_player_get(empty.get(), &info, &error), TACTUS_OK);
  EXPECT_EQ(info.next_tick, INT64_MAX);
  EXPECT_EQ(tactus_player_play(empty.get(), 100, nullptr, &error), TACTUS_NOTHING);
  EXPECT_EQ(error.rule, nullptr);
}

TEST(CDecoder, ReceiverReportsUpdatesAndAdvice) {
  const Scene scene = make_scene();
  const Sender sender = make_sender(scene);
  const Receiver receiver = make_receiver(scene);
  Truth truth;
  tactus_update updates[2];
  std::size_t count = 9;
  EXPECT_EQ(tactus_receiver_updates(receiver.get(), updates, 2, &count, nullptr), TACTUS_OK);
  EXPECT_EQ(count, 0u);
  std::size_t refused = 0, sent_packets = 0;
  for (std::int64_t tick = 0; tick < 600; ++tick) {
    for (const Packet& packet : encode(sender, tick, truth.at(tick))) {
      if (++sent_packets == 3) continue;  // lost
      tactus_packet_info info = sized<tactus_packet_info>();
      tactus_error error{};
      if (push(receiver, packet, TACTUS_PACKET_TICK, &info, &error) == TACTUS_OK) {
        EXPECT_EQ(info.number, packet.info.number);
        EXPECT_EQ(info.reason, packet.info.reason);
        ASSERT_EQ(tactus_receiver_updates(receiver.get(), updates, 2, &count, nullptr), TACTUS_OK);
        ASSERT_EQ(count, 1u);
        EXPECT_EQ(updates[0].object, 1u);
        EXPECT_EQ(tactus_receiver_updates(receiver.get(), updates, 0, &count, nullptr), TACTUS_BUFFER_TOO_SMALL);
        EXPECT_EQ(count, 1u);
      } else {
        ++refused;
        EXPECT_STREQ(error.rule, "R-PKT-4");
        EXPECT_EQ(error.status, TACTUS_STATE);
        EXPECT_EQ(error.advice, TACTUS_ADVICE_REQUEST_KEY);
        EXPECT_STRNE(error.text, "");
        EXPECT_EQ(tactus_sender_request_key(sender.get(), nullptr), TACTUS_OK);
        ASSERT_EQ(tactus_receiver_updates(receiver.get(), updates, 2, &count, nullptr), TACTUS_OK);
        EXPECT_EQ(count, 0u);  // those of the packet before are gone
      }
    }
  }
  EXPECT_EQ(refused, 1u);
  tactus_pose shown;
  ASSERT_EQ(tactus_receiver_poses(receiver.get(), 599, 1, 1, &shown, nullptr, nullptr), TACTUS_OK);
  EXPECT_NEAR(shown.position[0], truth.objects[1].pose.position[0], 3e-4);
}

TEST(CDecoder, SceneReportsWhatItHolds) {
  const Scene scene = make_scene(true);
  tactus_scene_info info = sized<tactus_scene_info>();
  ASSERT_EQ(tactus_scene_get(scene.get(), &info, nullptr), TACTUS_OK);
  EXPECT_EQ(info.tick_rate, 1000u);
  EXPECT_EQ(info.rigid, 2u);
  EXPECT_EQ(info.deformables, 1u);
  EXPECT_EQ(info.substreams, 2u);
  EXPECT_EQ(info.has_bounds, 1u);
  tactus_rigid_info cube = sized<tactus_rigid_info>();
  ASSERT_EQ(tactus_scene_get_rigid(scene.get(), 1, &cube, nullptr), TACTUS_OK);
  EXPECT_STREQ(cube.name, "cube");
  EXPECT_EQ(cube.dof, std::uint32_t{TACTUS_DOF_ALL});
  EXPECT_NEAR(cube.initial.position[2], 0.05, 1e-6);
  tactus_deformable_info sheet = sized<tactus_deformable_info>();
  ASSERT_EQ(tactus_scene_get_deformable(scene.get(), 0, &sheet, nullptr), TACTUS_OK);
  EXPECT_STREQ(sheet.name, "sheet");
  EXPECT_EQ(sheet.vertices, 4u);
  EXPECT_EQ(sheet.rings, 3u);
  EXPECT_EQ(sheet.frame_period, 1);
  float rest[12];
  std::uint32_t triangles[6];
  auto arrays = sized<tactus_mesh_arrays>();
  arrays.vertices = 4;
  arrays.triangles = 2;
  arrays.rest = rest;
  arrays.corners = triangles;
  ASSERT_EQ(tactus_scene_get_mesh(scene.get(), 0, &arrays, nullptr), TACTUS_OK);
  EXPECT_NEAR(rest[3], 0.1f, 1e-6f);
  EXPECT_EQ(triangles[5], 3u);
  auto rigid = sized<tactus_rigid_bounds>();
  auto deformable = sized<tactus_deformable_bounds>();
  auto load = sized<tactus_load_bounds>();
  EXPECT_EQ(sheet.has_stiffness, 0u);
  ASSERT_EQ(tactus_scene_get_bounds(scene.get(), &rigid, 0, &deformable, nullptr, nullptr), TACTUS_OK);
  EXPECT_EQ(rigid.weber_fraction, 0.04);
  EXPECT_EQ(deformable.visual, 3e-4);
  EXPECT_EQ(deformable.kept, 1);
  EXPECT_EQ(tactus_scene_get_bounds(scene.get(), &rigid, 0, nullptr, &load, nullptr), TACTUS_NOTHING);
}

TEST(CDecoder, SceneGoesThroughBytes) {
  const Scene scene = make_scene(true);
  std::size_t size = 0;
  ASSERT_EQ(tactus_scene_write(scene.get(), nullptr, 0, &size, nullptr), TACTUS_BUFFER_TOO_SMALL);
  std::vector<std::uint8_t> bytes(size + 3);
  ASSERT_EQ(tactus_scene_write(scene.get(), bytes.data(), bytes.size(), &size, nullptr), TACTUS_OK);
  tactus_scene* raw = nullptr;
  std::size_t used = 0;
  ASSERT_EQ(tactus_scene_parse(bytes.data(), bytes.size(), nullptr, &raw, &used, nullptr), TACTUS_OK);
  const Scene again(raw);
  EXPECT_EQ(used, size);
  std::vector<std::uint8_t> twice(size);
  ASSERT_EQ(tactus_scene_write(raw, twice.data(), twice.size(), &size, nullptr), TACTUS_OK);
  bytes.resize(size);
  EXPECT_EQ(bytes, twice);
}

TEST(CDecoder, LimitsAreKept) {
  const std::vector<std::uint8_t> file = make_stream(true);
  tactus_limits limits = filled<tactus_limits>();
  limits.vertices = 3;
  auto options = filled<tactus_receiver_options>();
  options.limits = &limits;
  tactus_player* player = nullptr;
  tactus_scene* scene = nullptr;
  EXPECT_REFUSED("R-STR-14", tactus_player_open, file.data(), file.size(), &options, &player);
  EXPECT_REFUSED("R-STR-14", tactus_scene_parse, file.data(), file.size(), &limits, &scene, nullptr);
  EXPECT_EQ(player, nullptr);
  EXPECT_EQ(scene, nullptr);
}

TEST(CDecoder, DamagedFilesGiveTheErrorsOfTheLibrary) {
  const std::vector<std::uint8_t> file = make_stream(true, 60);
  const auto check = [](const std::vector<std::uint8_t>& bytes) {
    const std::vector<std::uint8_t> exact(bytes);  // nothing behind its end
    tactus_player* raw = nullptr;
    tactus_error error{};
    const auto expected = tactus::Player::open(exact);
    const tactus_status opened = tactus_player_open(exact.data(), exact.size(), nullptr, &raw, &error);
    const Player player(raw);
    ASSERT_EQ(opened == TACTUS_OK, expected.has_value());
    if (!expected) {
      ASSERT_STREQ(error.rule, expected.error().rule);
      ASSERT_EQ(error.bit_offset, expected.error().bit_offset);
      return;
    }
    auto library = tactus::Player::open(exact).value();
    for (int i = 0; i < 200; ++i) {
      const auto played = library.play(std::numeric_limits<std::int64_t>::max());
      const tactus_status status = tactus_player_play(raw, std::numeric_limits<std::int64_t>::max(), nullptr, &error);
      ASSERT_EQ(status == TACTUS_OK, played.has_value() && played->has_value());
      if (status == TACTUS_NOTHING) return;
      if (status == TACTUS_OK) continue;
      ASSERT_STREQ(error.rule, played.error().rule);
      ASSERT_EQ(error.status, static_cast<int>(played.error().code));
      ASSERT_EQ(error.bit_offset, played.error().bit_offset);
      return;
    }
  };
  for (std::size_t size = 0; size <= file.size(); ++size) check({file.begin(), file.begin() + static_cast<std::ptrdiff_t>(size)});
  for (std::size_t i = 0; i < file.size(); ++i) {
    for (const std::uint8_t flip : {std::uint8_t{0x01}, std::uint8_t{0x80}, std::uint8_t{0xff}}) {
      std::vector<std::uint8_t> damaged = file;
      damaged[i] ^= flip;
      check(damaged);
    }
  }
}

}  // namespace
}  // namespace tactus::c_test
