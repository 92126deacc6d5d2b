// SPDX-License-Identifier: Apache-2.0
/// NULL, wrong sizes, indices of nothing and small buffers give a status with its rule, never a crash.
#include <tactus_session.h>

#include "tests/bindings/fixture.h"

namespace tactus::c_test {
namespace {

constexpr const char* kBad = "R-API-12";

TEST(CErrors, TextsComeWithTheRule) {
  tactus_error error{};
  tactus_player* player = nullptr;
  EXPECT_EQ(tactus_player_open(nullptr, 0, nullptr, &player, &error), TACTUS_TRUNCATED);
  EXPECT_STREQ(tactus_status_name(error.status), "truncated");
  EXPECT_STRNE(tactus_error_text(&error), "");
  EXPECT_STRNE(tactus_error_remedy(&error), "");
  EXPECT_STREQ(tactus_status_name(TACTUS_OK), "ok");
  EXPECT_STREQ(tactus_status_name(TACTUS_NOTHING), "nothing");
  EXPECT_STREQ(tactus_status_name(TACTUS_BUFFER_TOO_SMALL), "buffer_too_small");
  for (const tactus_status unknown : {-1, 1, 9, 13, 1000}) EXPECT_STRNE(tactus_status_name(unknown), nullptr);
  EXPECT_STRNE(tactus_error_text(nullptr), nullptr);
  EXPECT_STREQ(tactus_error_remedy(nullptr), "");
  EXPECT_EQ(tactus_error_advice(nullptr), TACTUS_ADVICE_NONE);
  EXPECT_EQ(tactus_version(), std::uint32_t{TACTUS_VERSION});
}

TEST(CErrors, OptionsAreChecked) {
  const Scene scene = make_scene();
  tactus_receiver* raw = nullptr;
  auto options = filled<tactus_receiver_options_init, tactus_receiver_options>();
  options.interpolation = 77;
  EXPECT_REFUSED("R-API-4", tactus_receiver_create, scene.get(), &options, &raw);
}

TEST(CErrors, DestroyTakesNull) {
  tactus_scene_destroy(nullptr);
  tactus_scene_builder_destroy(nullptr);
  tactus_receiver_destroy(nullptr);
  tactus_player_destroy(nullptr);
  tactus_sender_destroy(nullptr);
  tactus_writer_destroy(nullptr);
  tactus_server_destroy(nullptr);
  tactus_client_destroy(nullptr);
  EXPECT_EQ(tactus_player_receiver(nullptr), nullptr);
  EXPECT_EQ(tactus_receiver_scene(nullptr), nullptr);
  EXPECT_EQ(tactus_client_receiver(nullptr), nullptr);
  EXPECT_EQ(tactus_player_header_bytes(nullptr), 0u);
  EXPECT_EQ(tactus_player_complete(nullptr), 0);
  EXPECT_STREQ(tactus_scene_builder_culprit(nullptr), "");
}

TEST(CErrors, SceneRefuses) {
  const Scene scene = make_scene(true);
  tactus_scene* out = nullptr;
  auto info = sized<tactus_scene_info>();
  auto rigid = sized<tactus_rigid_info>();
  auto deformable = sized<tactus_deformable_info>();
  auto bounds = sized<tactus_rigid_bounds>();
  float rest[12];
  std::uint32_t triangles[6];
  std::uint8_t clusters[4];
  std::size_t size = 0;
  EXPECT_REFUSED(kBad, tactus_scene_parse, nullptr, 5, nullptr, &out, nullptr);
  EXPECT_REFUSED(kBad, tactus_scene_parse, nullptr, 0, nullptr, nullptr, nullptr);
  EXPECT_REFUSED(kBad, tactus_scene_write, nullptr, nullptr, 0, &size);
  EXPECT_REFUSED(kBad, tactus_scene_write, scene.get(), nullptr, 5, &size);
  EXPECT_REFUSED(kBad, tactus_scene_write, scene.get(), nullptr, 0, nullptr);
  EXPECT_REFUSED(kBad, tactus_scene_get, nullptr, &info);
  EXPECT_REFUSED(kBad, tactus_scene_get, scene.get(), nullptr);
  info.size = 4;
  EXPECT_REFUSED(kBad, tactus_scene_get, scene.get(), &info);
  EXPECT_REFUSED(kBad, tactus_scene_get_rigid, scene.get(), 2, &rigid);
  EXPECT_REFUSED(kBad, tactus_scene_get_deformable, scene.get(), 1, &deformable);
  EXPECT_REFUSED(kBad, tactus_scene_get_rest, scene.get(), 0, nullptr, 12);
  EXPECT_REFUSED("R-API-13", tactus_scene_get_rest, scene.get(), 0, rest, 11);
  EXPECT_REFUSED("R-API-13", tactus_scene_get_triangles, scene.get(), 0, triangles, 5);
  EXPECT_REFUSED(kBad, tactus_scene_get_triangles, scene.get(), 1, triangles, 6);
  EXPECT_REFUSED(kBad, tactus_scene_get_clusters, scene.get(), 0, nullptr, 4);
  EXPECT_REFUSED(kBad, tactus_scene_get_clusters, scene.get(), 1, clusters, 4);
  EXPECT_EQ(tactus_scene_get_clusters(scene.get(), 0, clusters, 4, nullptr), TACTUS_NOTHING);
  EXPECT_REFUSED(kBad, tactus_scene_get_rigid_bounds, nullptr, &bounds);
}

TEST(CErrors, BuilderReportsFigures) {
  const auto refused = [](const tactus_scene_options& options, const tactus_pose* pose, bool declares_bounds, const char* rule) {
    tactus_scene_builder* raw = nullptr;
    EXPECT_EQ(tactus_scene_builder_create(&options, &raw, nullptr), TACTUS_OK);
    const Builder builder(raw);
    for (const char* name : {"a", "b", "c"}) EXPECT_EQ(tactus_scene_builder_rigid(raw, name, pose, 63, nullptr), TACTUS_OK);
    if (declares_bounds) {
      EXPECT_EQ(tactus_scene_builder_declare_bounds(raw, nullptr, nullptr, nullptr, nullptr), TACTUS_OK);
    }
    tactus_scene* scene = nullptr;
    tactus_error error{};
    EXPECT_NE(tactus_scene_builder_build(raw, &scene, &error), TACTUS_OK);
    EXPECT_STREQ(error.rule, rule);
    return std::string(tactus_scene_builder_detail(raw));
  };
  auto options = filled<tactus_scene_options_init, tactus_scene_options>();
  const tactus_pose far{{0, 600, 0}, {1, 0, 0, 0}};
  EXPECT_NE(refused(options, &far, false, "R-API-2").find("reach 512 m"), std::string::npos);
  auto limits = filled<tactus_limits_init, tactus_limits>();
  limits.objects = 2;
  options.limits = &limits;
  EXPECT_EQ(refused(options, nullptr, false, "R-STR-14"), "3 objects where 2 are allowed");
  options.limits = nullptr;
  options.world_size = 4e6;  // the default bound of 0.3 mm needs 8 steps
  EXPECT_NE(refused(options, nullptr, true, "R-API-4").find("0.3 mm"), std::string::npos);
  options.world_size = 1000;
  tactus_scene_builder* raw = nullptr;
  ASSERT_EQ(tactus_scene_builder_create(&options, &raw, nullptr), TACTUS_OK);
  const Builder builder(raw);
  ASSERT_EQ(tactus_scene_builder_rigid(raw, "far", &far, 63, nullptr), TACTUS_OK);
  tactus_scene* scene = nullptr;
  ASSERT_EQ(tactus_scene_builder_build(raw, &scene, nullptr), TACTUS_OK);
  EXPECT_STREQ(tactus_scene_builder_detail(raw), "");
  EXPECT_STREQ(tactus_scene_builder_detail(nullptr), "");
  const Scene owned(scene);
  auto info = sized<tactus_scene_info>();
  ASSERT_EQ(tactus_scene_get(scene, &info, nullptr), TACTUS_OK);
  EXPECT_EQ(info.position_exp, 21u);
}

TEST(CErrors, BuilderRefusesAndNamesTheCulprit) {
  tactus_scene_builder* raw = nullptr;
  tactus_scene* scene = nullptr;
  EXPECT_REFUSED(kBad, tactus_scene_builder_create, nullptr, nullptr);
  auto options = filled<tactus_scene_options_init, tactus_scene_options>();
  options.position_exp = 300;
  EXPECT_REFUSED("R-API-4", tactus_scene_builder_create, &options, &raw);
  options = filled<tactus_scene_options_init, tactus_scene_options>();
  options.rigid_profile = 2;
  EXPECT_REFUSED("R-API-4", tactus_scene_builder_create, &options, &raw);
  ASSERT_EQ(tactus_scene_builder_create(nullptr, &raw, nullptr), TACTUS_OK);
  const Builder builder(raw);
  EXPECT_REFUSED(kBad, tactus_scene_builder_rigid, raw, nullptr, nullptr, 63);
  EXPECT_REFUSED(kBad, tactus_scene_builder_rigid, raw, "cube", nullptr, 64);
  EXPECT_REFUSED(kBad, tactus_scene_builder_build, raw, nullptr);
  const double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::uint32_t wrong[] = {0, 1, 7}, right[] = {0, 1, 2};
  EXPECT_REFUSED("R-SRF-9", tactus_scene_builder_deformable, raw, "sheet", corners, 3, wrong, 1, nullptr);
  EXPECT_REFUSED("R-SRF-14", tactus_scene_builder_deformable, raw, "sheet", corners, std::size_t{1} << 40, right, 1, nullptr);
  EXPECT_REFUSED(kBad, tactus_scene_builder_deformable, raw, "sheet", nullptr, 3, right, 1, nullptr);
  auto coding = filled<tactus_deformable_options_init, tactus_deformable_options>();
  coding.frame_period = NAN;
  EXPECT_REFUSED("R-API-4", tactus_scene_builder_deformable, raw, "sheet", corners, 3, right, 1, &coding);
  coding = filled<tactus_deformable_options_init, tactus_deformable_options>();
  coding.modes = 65;
  EXPECT_REFUSED("R-API-9", tactus_scene_builder_deformable, raw, "sheet", corners, 3, right, 1, &coding);
  coding = filled<tactus_deformable_options_init, tactus_deformable_options>();
  coding.cluster_count = 1;
  EXPECT_REFUSED(kBad, tactus_scene_builder_deformable, raw, "sheet", corners, 3, right, 1, &coding);
  coding.cluster_count = 65;
  EXPECT_REFUSED("R-API-4", tactus_scene_builder_deformable, raw, "sheet", corners, 3, right, 1, &coding);
  ASSERT_EQ(tactus_scene_builder_rigid(raw, "twin", nullptr, 63, nullptr), TACTUS_OK);
  ASSERT_EQ(tactus_scene_builder_rigid(raw, "twin", nullptr, 63, nullptr), TACTUS_OK);
  tactus_error error{};
  EXPECT_EQ(tactus_scene_builder_build(raw, &scene, &error), TACTUS_INVALID);
  EXPECT_STREQ(error.rule, "R-STR-11");
  EXPECT_STREQ(tactus_scene_builder_culprit(raw), "twin");
  EXPECT_EQ(scene, nullptr);
}

TEST(CErrors, ReceiverRefuses) {
  const Scene scene = make_scene(true);
  const Receiver receiver = make_receiver(scene);
  tactus_receiver* out = nullptr;
  tactus_pose poses[2];
  float u[12];
  double loads[9];
  std::uint64_t hash = 0;
  const std::uint8_t byte = 0;
  auto small = sized<tactus_packet_info>();
  small.size = 1;
  constexpr std::int64_t kFar = INT64_MAX;
  EXPECT_REFUSED(kBad, tactus_receiver_create, nullptr, nullptr, &out);
  EXPECT_REFUSED(kBad, tactus_receiver_create, scene.get(), nullptr, nullptr);
  EXPECT_REFUSED(kBad, tactus_receiver_push, nullptr, &byte, 1, 0, nullptr);
  EXPECT_REFUSED(kBad, tactus_receiver_push, receiver.get(), nullptr, 1, 0, nullptr);
  EXPECT_REFUSED(kBad, tactus_receiver_push, receiver.get(), &byte, 1, kFar, nullptr);
  EXPECT_REFUSED(kBad, tactus_receiver_push, receiver.get(), &byte, 1, 0, &small);
  EXPECT_REFUSED("R-PKT-6", tactus_receiver_push, receiver.get(), nullptr, 0, TACTUS_NO_CLOCK, nullptr);
  EXPECT_REFUSED(kBad, tactus_receiver_poses, receiver.get(), 0, 0, 3, poses);
  EXPECT_REFUSED(kBad, tactus_receiver_poses, receiver.get(), 0, 3, 0, poses);
  EXPECT_REFUSED(kBad, tactus_receiver_poses, receiver.get(), 0, 1, SIZE_MAX, poses);
  EXPECT_REFUSED(kBad, tactus_receiver_poses, receiver.get(), kFar, 0, 2, poses);
  EXPECT_REFUSED(kBad, tactus_receiver_poses, receiver.get(), 0, 0, 2, nullptr);
  EXPECT_REFUSED(kBad, tactus_receiver_displacements, receiver.get(), 1, 0, u, 12);
  EXPECT_REFUSED("R-API-13", tactus_receiver_displacements, receiver.get(), 0, 0, u, 11);
  EXPECT_REFUSED(kBad, tactus_receiver_loads, receiver.get(), 2, 0, loads, 9);
  EXPECT_EQ(tactus_receiver_loads(receiver.get(), 1, 0, loads, 9, nullptr), TACTUS_NOTHING);
  EXPECT_REFUSED(kBad, tactus_receiver_state_hash, receiver.get(), 2, &hash);
  EXPECT_REFUSED(kBad, tactus_receiver_pose_hash, receiver.get(), 0, nullptr);
}

TEST(CErrors, PlayerRefusesAndKeepsItsReceiver) {
  const std::vector<std::uint8_t> file = make_stream();
  tactus_player* raw = nullptr;
  EXPECT_REFUSED(kBad, tactus_player_open, file.data(), file.size(), nullptr, nullptr);
  EXPECT_REFUSED(kBad, tactus_player_open, nullptr, 5, nullptr, &raw);
  ASSERT_EQ(tactus_player_open(file.data(), file.size(), nullptr, &raw, nullptr), TACTUS_OK);
  const Player player(raw);
  EXPECT_REFUSED(kBad, tactus_player_play, nullptr, 0, nullptr);
  EXPECT_REFUSED(kBad, tactus_player_next_tick, raw, nullptr);
  tactus_receiver* receiver = tactus_player_receiver(raw);
  EXPECT_REFUSED(kBad, tactus_receiver_push, receiver, file.data(), 1, TACTUS_NO_CLOCK, nullptr);
  tactus_receiver_destroy(receiver);  // borrowed
  tactus_pose pose;
  EXPECT_EQ(tactus_receiver_poses(receiver, 0, 1, 1, &pose, nullptr), TACTUS_OK);
}

TEST(CErrors, SenderRefuses) {
  const Scene scene = make_scene(true);
  tactus_sender* out = nullptr;
  std::size_t count = 0, size = 0;
  EXPECT_REFUSED(kBad, tactus_sender_create, nullptr, nullptr, &out);
  auto rigid = filled<tactus_rigid_bounds_init, tactus_rigid_bounds>();
  auto options = filled<tactus_sender_options_init, tactus_sender_options>();
  options.rigid = &rigid;
  rigid.weber_fraction = NAN;
  EXPECT_REFUSED("R-API-4", tactus_sender_create, scene.get(), &options, &out);
  rigid = filled<tactus_rigid_bounds_init, tactus_rigid_bounds>();
  rigid.haptic = 9;
  EXPECT_REFUSED("R-API-4", tactus_sender_create, scene.get(), &options, &out);
  options.rigid = nullptr;
  for (const std::int32_t reduction : {-1, 2}) {
    options.reduction = reduction;
    EXPECT_REFUSED("R-API-4", tactus_sender_create, scene.get(), &options, &out);
  }
  const Sender sender = make_sender(scene);
  Truth truth(true);
  EXPECT_REFUSED(kBad, tactus_sender_encode, sender.get(), 0, nullptr, &count);
  EXPECT_REFUSED(kBad, tactus_sender_encode, sender.get(), 0, &truth.truth, nullptr);
  truth.truth.object_count = 1;
  EXPECT_REFUSED("R-API-5", tactus_sender_encode, sender.get(), 0, &truth.truth, &count);
  truth.truth.object_count = 2;
  truth.truth.shape_count = 2;
  EXPECT_REFUSED("R-API-5", tactus_sender_encode, sender.get(), 0, &truth.truth, &count);
  truth.truth.shape_count = 1;
  truth.shape.vertices = SIZE_MAX;
  EXPECT_REFUSED("R-API-5", tactus_sender_encode, sender.get(), 0, &truth.truth, &count);
  truth.at(0);
  tactus_contact contact{};
  contact.kind = 17;
  truth.truth.contacts = &contact;
  truth.truth.contact_count = 1;
  std::size_t held_count = 0;
  ASSERT_EQ(tactus_sender_encode(sender.get(), 0, &truth.truth, &count, nullptr), TACTUS_OK);
  EXPECT_REFUSED("R-API-13", tactus_sender_held, sender.get(), nullptr, 0, &held_count);
  ASSERT_EQ(held_count, 1u);
  tactus_held held{};
  ASSERT_EQ(tactus_sender_held(sender.get(), &held, 1, &held_count, nullptr), TACTUS_OK);
  EXPECT_TRUE(held.part == TACTUS_PART_CONTACT && held.index == 0 && held.since == 0);
  EXPECT_STREQ(held.rule, "R-API-15");
  EXPECT_STREQ(held.name, "");
  EXPECT_REFUSED(kBad, tactus_sender_held, nullptr, &held, 1, &held_count);
  EXPECT_REFUSED(kBad, tactus_sender_held, sender.get(), &held, 1, nullptr);
  truth.truth.contact_count = 0;
  truth.truth.loads = &contact.stiffness;
  truth.truth.load_count = 2;
  EXPECT_REFUSED("R-API-5", tactus_sender_encode, sender.get(), 1, &truth.truth, &count);
  truth.truth.load_count = 0;
  truth.objects[1].pose.position[0] = NAN;
  ASSERT_EQ(tactus_sender_encode(sender.get(), 1, &truth.truth, &count, nullptr), TACTUS_OK);
  ASSERT_EQ(tactus_sender_held(sender.get(), &held, 1, &held_count, nullptr), TACTUS_OK);
  ASSERT_EQ(held_count, 1u);
  EXPECT_TRUE(held.part == TACTUS_PART_OBJECT && held.index == 1 && held.since == 1);
  EXPECT_STREQ(held.rule, "R-API-1");
  auto named = sized<tactus_rigid_info>();
  ASSERT_EQ(tactus_scene_get_rigid(scene.get(), 1, &named, nullptr), TACTUS_OK);
  EXPECT_STREQ(held.name, named.name);
  truth.objects[1].pose.position[0] = 0;
  ASSERT_EQ(tactus_sender_encode(sender.get(), 5, truth.at(0), &count, nullptr), TACTUS_OK);
  ASSERT_EQ(tactus_sender_held(sender.get(), nullptr, 0, &held_count, nullptr), TACTUS_OK);
  EXPECT_EQ(held_count, 0u);
  EXPECT_REFUSED("R-API-5", tactus_sender_encode, sender.get(), 5, truth.at(5), &count);
  EXPECT_REFUSED(kBad, tactus_sender_packet, sender.get(), 9, nullptr, nullptr, 0, &size);
  EXPECT_REFUSED(kBad, tactus_sender_acknowledge, sender.get(), 7, 1);
  EXPECT_REFUSED(kBad, tactus_sender_acknowledge, sender.get(), 0, 1u << 16);
  EXPECT_REFUSED("R-API-4", tactus_sender_set_link, sender.get(), 5, NAN);
  EXPECT_REFUSED("R-API-4", tactus_sender_set_link, sender.get(), -1, 0);
}

TEST(CErrors, SmallBufferLosesNothing) {
  const Scene scene = make_scene();
  const Sender sender = make_sender(scene);
  Truth truth;
  std::size_t count = 0, size = 0;
  std::int64_t tick = 0;
  for (; count == 0; ++tick) ASSERT_EQ(tactus_sender_encode(sender.get(), tick, truth.at(tick), &count, nullptr), TACTUS_OK);
  std::uint8_t bytes[64];
  EXPECT_REFUSED("R-API-13", tactus_sender_packet, sender.get(), 0, nullptr, bytes, 1, &size);
  ASSERT_GT(size, 1u);
  std::size_t written = 0;
  EXPECT_EQ(tactus_sender_packet(sender.get(), 0, nullptr, bytes, size, &written, nullptr), TACTUS_OK);
  EXPECT_EQ(written, size);
}

TEST(CErrors, WriterRefuses) {
  const Scene scene = make_scene();
  tactus_writer* raw = nullptr;
  const std::uint8_t byte = 0;
  EXPECT_REFUSED(kBad, tactus_writer_create, nullptr, &raw);
  ASSERT_EQ(tactus_writer_create(scene.get(), &raw, nullptr), TACTUS_OK);
  const Writer writer(raw);
  EXPECT_REFUSED(kBad, tactus_writer_add, raw, 0, nullptr, 1, 0);
  EXPECT_REFUSED("R-API-5", tactus_writer_add, raw, -1, &byte, 1, 0);
  ASSERT_EQ(tactus_writer_finish(raw, nullptr), TACTUS_OK);
  EXPECT_REFUSED("R-API-5", tactus_writer_finish, raw);
  EXPECT_REFUSED("R-API-5", tactus_writer_add, raw, 9, &byte, 1, 0);
  EXPECT_FALSE(take(writer).empty());
  EXPECT_TRUE(take(writer).empty());
}

}  // namespace
}  // namespace tactus::c_test
