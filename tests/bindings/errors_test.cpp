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
  EXPECT_STREQ(error.name, "truncated");
  for (const char* text : {error.text, error.remedy, error.rule}) EXPECT_STRNE(text, "");
  for (const char* text : {error.object, error.detail}) EXPECT_STREQ(text, "");
  tactus_error same{};
  EXPECT_EQ(tactus_describe(error.status, error.rule, &same), TACTUS_OK);
  EXPECT_STREQ(same.text, error.text);
  EXPECT_EQ(same.advice, error.advice);
  for (const auto& [status, name] :
       {std::pair{TACTUS_OK, "ok"}, {TACTUS_NOTHING, "nothing"}, {TACTUS_BUFFER_TOO_SMALL, "buffer_too_small"}}) {
    EXPECT_EQ(tactus_describe(status, nullptr, &same), TACTUS_OK);
    EXPECT_STREQ(same.name, name);
  }
  for (const tactus_status unknown : {-1, 1, 9, 13, 1000}) {
    EXPECT_EQ(tactus_describe(unknown, "R-NONE-1", &same), TACTUS_OK);
    EXPECT_STRNE(same.name, nullptr);
    EXPECT_STRNE(same.text, nullptr);
    EXPECT_EQ(same.advice, TACTUS_ADVICE_NONE);
  }
  EXPECT_EQ(tactus_describe(TACTUS_OK, "", nullptr), TACTUS_INVALID_ARGUMENT);
  tactus_limits limits;
  for (const std::int32_t kind : {-1, 0, 15}) EXPECT_EQ(tactus_init(kind, &limits, sizeof limits), TACTUS_INVALID_ARGUMENT);
  EXPECT_EQ(tactus_version(), std::uint32_t{TACTUS_VERSION});
}

TEST(CErrors, OptionsAreChecked) {
  const Scene scene = make_scene();
  tactus_receiver* raw = nullptr;
  auto options = filled<tactus_receiver_options>();
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
  double stiffness = 0;
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
  auto arrays = sized<tactus_mesh_arrays>();
  EXPECT_REFUSED(kBad, tactus_scene_get_mesh, scene.get(), 0, nullptr);
  EXPECT_REFUSED(kBad, tactus_scene_get_mesh, scene.get(), 1, &arrays);
  EXPECT_EQ(tactus_scene_get_mesh(scene.get(), 0, &arrays, nullptr), TACTUS_OK) << "nothing is wanted";
  arrays.rest = rest;
  arrays.vertices = 3;
  EXPECT_REFUSED("R-API-13", tactus_scene_get_mesh, scene.get(), 0, &arrays);
  arrays.vertices = 4;
  arrays.corners = triangles;
  arrays.triangles = 1;
  EXPECT_REFUSED("R-API-13", tactus_scene_get_mesh, scene.get(), 0, &arrays);
  arrays.triangles = 2;
  for (float& x : rest) x = 9;
  arrays.clusters = clusters;
  EXPECT_EQ(tactus_scene_get_mesh(scene.get(), 0, &arrays, nullptr), TACTUS_NOTHING);
  arrays.clusters = nullptr;
  arrays.stiffness = &stiffness;
  EXPECT_EQ(tactus_scene_get_mesh(scene.get(), 0, &arrays, nullptr), TACTUS_NOTHING);
  EXPECT_EQ(rest[3], 9) << "nothing is written";
  auto deformable_bounds = sized<tactus_deformable_bounds>();
  EXPECT_REFUSED(kBad, tactus_scene_get_bounds, nullptr, &bounds, 0, nullptr, nullptr);
  EXPECT_REFUSED(kBad, tactus_scene_get_bounds, scene.get(), nullptr, 1, &deformable_bounds, nullptr);
}

TEST(CErrors, BuilderReportsFigures) {
  const auto refused = [](const tactus_scene_options& options, const tactus_pose* pose, bool declares_bounds, const char* rule) {
    tactus_scene_builder* raw = nullptr;
    EXPECT_EQ(tactus_scene_builder_create(&options, &raw, nullptr), TACTUS_OK);
    const Builder builder(raw);
    auto object = filled<tactus_rigid_options>();
    if (pose != nullptr) object.initial = *pose;
    for (const char* name : {"a", "b", "c"}) EXPECT_EQ(tactus_scene_builder_rigid(raw, name, &object, nullptr), TACTUS_OK);
    if (declares_bounds) {
      EXPECT_EQ(tactus_scene_builder_declare_bounds(raw, nullptr, nullptr, nullptr, nullptr), TACTUS_OK);
    }
    tactus_scene* scene = nullptr;
    tactus_error error{};
    EXPECT_NE(tactus_scene_builder_build(raw, &scene, &error), TACTUS_OK);
    EXPECT_STREQ(error.rule, rule);
    return std::string(error.detail);
  };
  auto options = filled<tactus_scene_options>();
  const tactus_pose far{{0, 600, 0}, {1, 0, 0, 0}};
  EXPECT_NE(refused(options, &far, false, "R-API-2").find("reach 512 m"), std::string::npos);
  auto limits = filled<tactus_limits>();
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
  auto object = filled<tactus_rigid_options>();
  object.initial = far;
  ASSERT_EQ(tactus_scene_builder_rigid(raw, "far", &object, nullptr), TACTUS_OK);
  tactus_scene* scene = nullptr;
  ASSERT_EQ(tactus_scene_builder_build(raw, &scene, nullptr), TACTUS_OK);
  const Scene owned(scene);
  auto info = sized<tactus_scene_info>();
  ASSERT_EQ(tactus_scene_get(scene, &info, nullptr), TACTUS_OK);
  EXPECT_EQ(info.position_exp, 21u);
}

TEST(CErrors, BuilderRefusesAndNamesTheCulprit) {
  tactus_scene_builder* raw = nullptr;
  tactus_scene* scene = nullptr;
  EXPECT_REFUSED(kBad, tactus_scene_builder_create, nullptr, nullptr);
  auto options = filled<tactus_scene_options>();
  options.position_exp = 300;
  EXPECT_REFUSED("R-API-4", tactus_scene_builder_create, &options, &raw);
  options = filled<tactus_scene_options>();
  options.rigid_profile = 2;
  EXPECT_REFUSED("R-API-4", tactus_scene_builder_create, &options, &raw);
  ASSERT_EQ(tactus_scene_builder_create(nullptr, &raw, nullptr), TACTUS_OK);
  const Builder builder(raw);
  EXPECT_REFUSED(kBad, tactus_scene_builder_rigid, raw, nullptr, nullptr);
  auto object = filled<tactus_rigid_options>();
  object.dof = 64;
  EXPECT_REFUSED("R-API-4", tactus_scene_builder_rigid, raw, "cube", &object);
  EXPECT_REFUSED(kBad, tactus_scene_builder_build, raw, nullptr);
  const double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::uint32_t wrong[] = {0, 1, 7}, right[] = {0, 1, 2};
  EXPECT_REFUSED("R-SRF-9", tactus_scene_builder_deformable, raw, "sheet", corners, 3, wrong, 1, nullptr);
  EXPECT_REFUSED("R-SRF-14", tactus_scene_builder_deformable, raw, "sheet", corners, std::size_t{1} << 40, right, 1, nullptr);
  EXPECT_REFUSED(kBad, tactus_scene_builder_deformable, raw, "sheet", nullptr, 3, right, 1, nullptr);
  auto coding = filled<tactus_deformable_options>();
  coding.frame_period = NAN;
  EXPECT_REFUSED("R-API-4", tactus_scene_builder_deformable, raw, "sheet", corners, 3, right, 1, &coding);
  coding = filled<tactus_deformable_options>();
  coding.modes = 65;
  EXPECT_REFUSED("R-API-9", tactus_scene_builder_deformable, raw, "sheet", corners, 3, right, 1, &coding);
  coding = filled<tactus_deformable_options>();
  coding.cluster_count = 1;
  EXPECT_REFUSED(kBad, tactus_scene_builder_deformable, raw, "sheet", corners, 3, right, 1, &coding);
  coding.cluster_count = 65;
  EXPECT_REFUSED("R-API-4", tactus_scene_builder_deformable, raw, "sheet", corners, 3, right, 1, &coding);
  ASSERT_EQ(tactus_scene_builder_rigid(raw, "twin", nullptr, nullptr), TACTUS_OK);
  ASSERT_EQ(tactus_scene_builder_rigid(raw, "twin", nullptr, nullptr), TACTUS_OK);
  tactus_error error{};
  EXPECT_EQ(tactus_scene_builder_build(raw, &scene, &error), TACTUS_INVALID);
  EXPECT_STREQ(error.rule, "R-STR-11");
  EXPECT_STREQ(error.object, "twin");
  EXPECT_STREQ(error.detail, "");
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
  EXPECT_REFUSED(kBad, tactus_receiver_push, nullptr, 1, &byte, 1, 0, nullptr);
  EXPECT_REFUSED(kBad, tactus_receiver_push, receiver.get(), 1, nullptr, 1, 0, nullptr);
  EXPECT_REFUSED(kBad, tactus_receiver_push, receiver.get(), 1, &byte, 1, kFar, nullptr);
  EXPECT_REFUSED(kBad, tactus_receiver_push, receiver.get(), 1, &byte, 1, 0, &small);
  for (const std::uint64_t number : {std::uint64_t{0}, std::uint64_t{1} << 62, UINT64_MAX})
    EXPECT_REFUSED("R-API-5", tactus_receiver_push, receiver.get(), number, &byte, 1, TACTUS_PACKET_TICK, nullptr);
  EXPECT_REFUSED("R-PKT-6", tactus_receiver_push, receiver.get(), 1, &byte, 0, TACTUS_PACKET_TICK, nullptr);
  EXPECT_REFUSED("R-API-5", tactus_receiver_push, receiver.get(), 0, nullptr, 0, TACTUS_PACKET_TICK, nullptr);
  EXPECT_REFUSED(kBad, tactus_receiver_poses, receiver.get(), 0, 0, 3, poses, nullptr);
  EXPECT_REFUSED(kBad, tactus_receiver_poses, receiver.get(), 0, 3, 0, poses, nullptr);
  EXPECT_REFUSED(kBad, tactus_receiver_poses, receiver.get(), 0, 1, SIZE_MAX, poses, nullptr);
  EXPECT_REFUSED(kBad, tactus_receiver_poses, receiver.get(), kFar, 0, 2, poses, nullptr);
  EXPECT_EQ(tactus_receiver_poses(receiver.get(), 0, 0, 2, nullptr, nullptr, nullptr), TACTUS_OK) << "nothing is wanted";
  EXPECT_REFUSED(kBad, tactus_receiver_displacements, receiver.get(), 1, 0, u, 12);
  EXPECT_REFUSED("R-API-13", tactus_receiver_displacements, receiver.get(), 0, 0, u, 11);
  EXPECT_REFUSED(kBad, tactus_receiver_loads, receiver.get(), 2, 0, loads, 9);
  EXPECT_EQ(tactus_receiver_loads(receiver.get(), 1, 0, loads, 9, nullptr), TACTUS_NOTHING);
  EXPECT_REFUSED(kBad, tactus_receiver_hash, receiver.get(), 2, &hash, 0, nullptr);
  EXPECT_REFUSED(kBad, tactus_receiver_hash, receiver.get(), 0, nullptr, kFar, &hash);
  EXPECT_REFUSED(kBad, tactus_receiver_hash, nullptr, 0, &hash, 0, nullptr);
  EXPECT_EQ(tactus_receiver_hash(receiver.get(), 2, nullptr, kFar, nullptr, nullptr), TACTUS_OK) << "nothing is wanted";
}

TEST(CErrors, PlayerRefusesAndKeepsItsReceiver) {
  const std::vector<std::uint8_t> file = make_stream();
  tactus_player* raw = nullptr;
  EXPECT_REFUSED(kBad, tactus_player_open, file.data(), file.size(), nullptr, nullptr);
  EXPECT_REFUSED(kBad, tactus_player_open, nullptr, 5, nullptr, &raw);
  ASSERT_EQ(tactus_player_open(file.data(), file.size(), nullptr, &raw, nullptr), TACTUS_OK);
  const Player player(raw);
  EXPECT_REFUSED(kBad, tactus_player_play, nullptr, 0, nullptr);
  EXPECT_REFUSED(kBad, tactus_player_get, raw, nullptr);
  auto info = sized<tactus_player_info>();
  EXPECT_REFUSED(kBad, tactus_player_get, nullptr, &info);
  tactus_receiver* receiver = tactus_player_receiver(raw);
  EXPECT_REFUSED(kBad, tactus_receiver_push, receiver, 1, file.data(), 1, TACTUS_PACKET_TICK, nullptr);
  tactus_receiver_destroy(receiver);  // borrowed
  tactus_pose pose;
  EXPECT_EQ(tactus_receiver_poses(receiver, 0, 1, 1, &pose, nullptr, nullptr), TACTUS_OK);
}

TEST(CErrors, SenderRefuses) {
  const Scene scene = make_scene(true);
  tactus_sender* out = nullptr;
  auto encoded = sized<tactus_encoded>();
  EXPECT_REFUSED(kBad, tactus_sender_create, nullptr, nullptr, &out);
  auto rigid = filled<tactus_rigid_bounds>();
  auto options = filled<tactus_sender_options>();
  options.rigid = &rigid;
  rigid.weber_fraction = NAN;
  EXPECT_REFUSED("R-API-4", tactus_sender_create, scene.get(), &options, &out);
  rigid = filled<tactus_rigid_bounds>();
  rigid.haptic = 9;
  EXPECT_REFUSED("R-API-4", tactus_sender_create, scene.get(), &options, &out);
  options.rigid = nullptr;
  for (const std::int32_t reduction : {-1, 2}) {
    options.reduction = reduction;
    EXPECT_REFUSED("R-API-4", tactus_sender_create, scene.get(), &options, &out);
  }
  const Sender sender = make_sender(scene);
  Truth truth(true);
  EXPECT_REFUSED(kBad, tactus_sender_encode, sender.get(), 0, nullptr, &encoded);
  EXPECT_REFUSED(kBad, tactus_sender_encode, sender.get(), 0, &truth.truth, nullptr);
  truth.truth.object_count = 1;
  EXPECT_REFUSED("R-API-5", tactus_sender_encode, sender.get(), 0, &truth.truth, &encoded);
  truth.truth.object_count = 2;
  truth.truth.shape_count = 2;
  EXPECT_REFUSED("R-API-5", tactus_sender_encode, sender.get(), 0, &truth.truth, &encoded);
  truth.truth.shape_count = 1;
  truth.shape.vertices = SIZE_MAX;
  EXPECT_REFUSED("R-API-5", tactus_sender_encode, sender.get(), 0, &truth.truth, &encoded);
  truth.at(0);
  tactus_contact contact{};
  contact.kind = 17;
  truth.truth.contacts = &contact;
  truth.truth.contact_count = 1;
  ASSERT_EQ(tactus_sender_encode(sender.get(), 0, &truth.truth, &encoded, nullptr), TACTUS_OK);
  ASSERT_EQ(encoded.held_count, 1u);
  tactus_held held = encoded.held[0];
  EXPECT_TRUE(held.part == TACTUS_PART_CONTACT && held.index == 0 && held.since == 0);
  EXPECT_STREQ(held.rule, "R-API-15");
  EXPECT_STREQ(held.name, "");
  truth.truth.contact_count = 0;
  truth.truth.loads = &contact.stiffness;
  truth.truth.load_count = 2;
  EXPECT_REFUSED("R-API-5", tactus_sender_encode, sender.get(), 1, &truth.truth, &encoded);
  truth.truth.load_count = 0;
  truth.objects[1].pose.position[0] = NAN;
  ASSERT_EQ(tactus_sender_encode(sender.get(), 1, &truth.truth, &encoded, nullptr), TACTUS_OK);
  ASSERT_EQ(encoded.held_count, 1u);
  held = encoded.held[0];
  EXPECT_TRUE(held.part == TACTUS_PART_OBJECT && held.index == 1 && held.since == 1);
  EXPECT_STREQ(held.rule, "R-API-1");
  auto named = sized<tactus_rigid_info>();
  ASSERT_EQ(tactus_scene_get_rigid(scene.get(), 1, &named, nullptr), TACTUS_OK);
  EXPECT_STREQ(held.name, named.name);
  truth.objects[1].pose.position[0] = 0;
  ASSERT_EQ(tactus_sender_encode(sender.get(), 5, truth.at(0), &encoded, nullptr), TACTUS_OK);
  EXPECT_EQ(encoded.held_count, 0u);
  EXPECT_REFUSED("R-API-5", tactus_sender_encode, sender.get(), 5, truth.at(5), &encoded);
  EXPECT_REFUSED(kBad, tactus_sender_acknowledge, sender.get(), 7, 1);
  EXPECT_REFUSED(kBad, tactus_sender_acknowledge, nullptr, 0, 1);
  for (const std::uint64_t number : {std::uint64_t{0}, std::uint64_t{1} << 40, UINT64_MAX})
    EXPECT_EQ(tactus_sender_acknowledge(sender.get(), 0, number, nullptr), TACTUS_OK) << "no packet has it: ignored";
  EXPECT_REFUSED("R-API-4", tactus_sender_set_link, sender.get(), 5, NAN);
  EXPECT_REFUSED("R-API-4", tactus_sender_set_link, sender.get(), -1, 0);
}

TEST(CErrors, SmallBufferLosesNothing) {
  const Scene scene = make_scene();
  tactus_writer* raw = nullptr;
  ASSERT_EQ(tactus_writer_create(scene.get(), &raw, nullptr), TACTUS_OK);
  const Writer writer(raw);
  std::uint8_t bytes[4096];
  std::size_t size = 0, written = 0;
  EXPECT_REFUSED("R-API-13", tactus_writer_take, raw, bytes, 1, &size);
  ASSERT_GT(size, 1u);
  ASSERT_LE(size, sizeof bytes);
  EXPECT_EQ(tactus_writer_take(raw, bytes, size, &written, nullptr), TACTUS_OK);
  EXPECT_EQ(written, size);
}

TEST(CErrors, WriterRefuses) {
  const Scene scene = make_scene();
  tactus_writer* raw = nullptr;
  const std::uint8_t byte = 0;
  EXPECT_REFUSED(kBad, tactus_writer_create, nullptr, &raw);
  ASSERT_EQ(tactus_writer_create(scene.get(), &raw, nullptr), TACTUS_OK);
  const Writer writer(raw);
  EXPECT_REFUSED(kBad, tactus_writer_add, raw, 0, 1, nullptr, 1, 0);
  EXPECT_REFUSED("R-API-5", tactus_writer_add, raw, -1, 1, &byte, 1, 0);
  EXPECT_REFUSED("R-API-5", tactus_writer_add, raw, 0, 0, &byte, 1, 0);
  ASSERT_EQ(tactus_writer_add(raw, 0, 7, &byte, 1, 0, nullptr), TACTUS_OK);
  for (const std::uint64_t number : {7u, 9u}) EXPECT_REFUSED("R-API-5", tactus_writer_add, raw, 0, number, &byte, 1, 0);
  ASSERT_EQ(tactus_writer_finish(raw, nullptr), TACTUS_OK);
  EXPECT_REFUSED("R-API-5", tactus_writer_finish, raw);
  EXPECT_REFUSED("R-API-5", tactus_writer_add, raw, 9, 1, &byte, 1, 0);
  EXPECT_FALSE(take(writer).empty());
  EXPECT_TRUE(take(writer).empty());
}

}  // namespace
}  // namespace tactus::c_test
