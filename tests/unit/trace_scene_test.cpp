// SPDX-License-Identifier: Apache-2.0
// From a trace to a stream and back: io/trace/trace_scene.h, metrics/*.h.
#include <tactus/trace/trace_scene.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <sstream>

#include <tactus/base/rule.h>
#include <tactus/metrics/deformable_errors.h>
#include <tactus/metrics/rates.h>
#include <tactus/rigid/rigid_states.h>
#include "tests/property/allocated.h"
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

constexpr std::uint32_t kSquares = 12;

/// A cube that drifts, a table, and a sheet with a dent as a trace would hold it, new every second tick, touched by one of two users.
class SheetTrace {
 public:
  SheetTrace() : sheet_(testing::sheet(kSquares, kSquares)), dented_(sheet_, kSquares) {
    info.objects = {{"cube", Dof::all}, {"table", Dof::none}};
    info.meshes = {{"sheet", sheet_, {}, 2}, {"still", testing::sheet(1, 1), {}, 2}};
    info.users = {{"left"}, {"right"}};
    frame.objects.resize(2);
    frame.users.resize(2);
    frame.meshes = {{false, std::vector<float>(3 * sheet_.vertices.size())}, {false, std::vector<float>(12)}};
  }
  void move(std::int64_t tick) {
    frame.tick = tick;
    frame.objects[0].pose.position = {0.25 + 0.001 * static_cast<double>(tick), 0, 0};
    frame.users[1].contact = testing::touch(0, frame.objects[0].pose, 0.001);
    frame.meshes[0].updated = tick % 2 == 0;
    frame.users[0].surface_contact.reset();
    if (!frame.meshes[0].updated) return;
    testing::SheetFrame shape = dented_.frame(tick / 2);
    frame.meshes[0].displacements = std::move(shape.displacements);
    if (!shape.touch) return;
    frame.users[0].surface_contact = {0, shape.touch->triangle, {1, 0, 0}, {0, 0, shape.touch->force / 500}, {0, 0, 1}, 500};
  }

  TraceInfo info;
  TraceFrame frame;

 private:
  TriMesh sheet_;
  testing::DentedSheet dented_;
};

SharedScene scene_of(const SheetTrace& trace, const TraceCoding& coding = {}) {
  return scene_builder(trace.info, trace.frame, coding)->build(testing::kWithThesis).value();
}

TEST(TraceScene, LightestTouchCounts) {
  TraceFrame frame;
  frame.users.resize(3);
  frame.users[0].surface_contact = {0, 5, {1, 0, 0}, {0, 0, 0.003}, {0, 0, 1}, 100};
  frame.users[1].surface_contact = {0, 6, {1, 0, 0}, {0, 0, 0.002}, {0, 0, 1}, 100};
  frame.users[1].device.position = {0, 0, 0.001};
  frame.users[2].surface_contact = {1, 7, {1, 0, 0}, {}, {0, 0, 1}, 100};
  const auto touch = touch_of(frame, 0);
  ASSERT_TRUE(touch);
  EXPECT_EQ(touch->triangle, 6u);
  EXPECT_NEAR(touch->force, 0.1, 1e-12);
  EXPECT_EQ(touch->stiffness, 100);
  EXPECT_EQ(touch_of(frame, 1)->triangle, 7u);
  EXPECT_FALSE(touch_of(frame, 2));
}

TEST(TraceScene, TakesFirstPosesAtRest) {
  SheetTrace trace;
  trace.move(0);
  trace.frame.objects[0].velocity = {1, 0, 0};
  const SharedScene scene = scene_of(trace);
  EXPECT_EQ(scene->tick_rate, 1000u);
  EXPECT_EQ(scene->max_extrapolation, 2000);
  EXPECT_EQ(scene->objects[0].initial.position[0], 1 << 20);
  EXPECT_EQ(scene->objects[1].dof, Dof::none);
  ASSERT_EQ(scene->moving().size(), 1u);
  EXPECT_EQ(initial_states(*scene).objects[0].velocity, Vec3i{});
  ASSERT_EQ(scene->deformables.size(), 2u);
  EXPECT_EQ(scene->deformables[0].frame_period, 512u);
  EXPECT_FALSE(scene->bounds);
}

TEST(TraceScene, DeclaresWhatTheSenderIsGiven) {
  SheetTrace trace;
  trace.move(0);
  const SenderOptions sender{.triggers = {.visual_position = 0.01}, .deformable = {.thresholds = {.visual = 1e-3}}};
  const auto scene = scene_builder(trace.info, trace.frame, {}, sender)->build();
  ASSERT_TRUE(scene);
  ASSERT_TRUE((*scene)->bounds && (*scene)->bounds->rigid);
  EXPECT_EQ((*scene)->bounds->rigid->visual_position, 0.01);
  ASSERT_EQ((*scene)->bounds->deformables.size(), 2u);
  EXPECT_EQ((*scene)->bounds->deformables[1].thresholds.visual, 1e-3);
}

TEST(TraceScene, RefusesWhatDoesNotFit) {
  SheetTrace trace;
  trace.move(0);
  TraceFrame few = trace.frame;
  few.objects.pop_back();
  EXPECT_STREQ(scene_builder(trace.info, few).error().rule, "R-API-5");
  const TraceCoding no_basis{.deformable = {}, .basis = [](const TraceDeformable&) -> Result<ModeBasis> {
                               return fail(Errc::invalid_argument, "R-API-9");
                             }};
  EXPECT_STREQ(scene_builder(trace.info, trace.frame, no_basis).error().rule, "R-API-9");
  trace.info.meshes[1].rest.vertices[3].x = 1e5;
  const auto far = scene_builder(trace.info, trace.frame)->build();
  ASSERT_FALSE(far);
  EXPECT_STREQ(far.error().error.rule, "R-API-2");
  EXPECT_EQ(far.error().object, "still");
}

TEST(FrameTruth, SaysWhatAFrameHolds) {
  SheetTrace trace;
  FrameTruth frames(trace.info);
  std::size_t touched = 0;
  for (std::int64_t tick = 0; tick < 60; ++tick) {
    trace.move(tick);
    const Truth truth = frames.of(trace.frame);
    EXPECT_EQ(truth.objects.data(), trace.frame.objects.data());
    ASSERT_EQ(truth.contacts.size(), 2u);
    EXPECT_EQ(truth.contacts[0].kind, ContactKind::none);
    EXPECT_EQ(truth.contacts[1].kind, ContactKind::surface);
    EXPECT_EQ(truth.contacts[1].device, trace.frame.users[1].contact.device);
    ASSERT_EQ(truth.deformables.size(), 2u);
    EXPECT_EQ(truth.deformables[0].displacements.empty(), tick % 2 == 1) << "a shape that is not new is none";
    EXPECT_EQ(truth.deformables[0].touch.has_value(), touch_of(trace.frame, 0).has_value());
    EXPECT_TRUE(truth.deformables[1].displacements.empty());
    touched += truth.deformables[0].touch ? 1u : 0u;
  }
  EXPECT_GT(touched, 10u);
}

class TracedScene : public ::testing::TestWithParam<std::tuple<DeformableProfile, bool>> {};

TEST_P(TracedScene, BoundsHoldAndAPlayerShowsTheSame) {
  const auto& [profile, layered] = GetParam();
  SheetTrace trace;
  trace.move(0);
  TraceCoding coding;
  coding.deformable.profile = profile;
  coding.deformable.layered = layered;
  coding.basis = [](const TraceDeformable& mesh) -> Result<ModeBasis> {
    return mesh.name == "sheet" ? testing::wave_basis(mesh.rest, kSquares, 6) : ModeBasis{};
  };
  const SharedScene scene = scene_of(trace, coding);
  ASSERT_EQ(scene->deformables.size(), 2u);
  EXPECT_EQ(scene->deformables[0].layered, layered);
  EXPECT_EQ(scene->deformables[0].basis.steps.size(), profile == DeformableProfile::main ? 6u : 0u);
  const SenderOptions options{};
  auto sender = Sender::create(scene, options).value();
  auto receiver = Receiver::create(scene).value();
  FrameTruth frames(trace.info);
  DeformableErrors errors(trace.info.meshes[0].rest, options.deformable.thresholds, scene->deformables[0].rings,
                          scene->grid.position);
  DeformableRates traffic;
  std::ostringstream file(std::ios::binary);
  auto writer = StreamFileWriter::create(file, *scene).value();
  std::vector<std::vector<Vec3i>> shown;
  std::vector<std::uint64_t> poses;
  std::size_t sent = 0;
  for (std::int64_t tick = 0; tick < 400; ++tick) {
    trace.move(tick);
    const Truth truth = frames.of(trace.frame);
    for (const Packet& packet : testing::all(sender.encode(tick, truth))) {
      ASSERT_TRUE(receiver.push(packet.number, packet.bytes));
      ASSERT_TRUE(writer.add(tick, packet.number, packet.bytes, packet.key));
      ++sent;
      if (packet.substream == 1) traffic.add(packet.bytes.size(), packet.updates, packet.key, packet.layer);
    }
    const auto displacements = receiver.replica().displacements(0, tick);
    shown.emplace_back(displacements.begin(), displacements.end());
    poses.push_back(receiver.replica().pose_hash(tick));
    if (trace.frame.meshes[0].updated) errors.add(trace.frame.meshes[0].displacements, shown.back(), truth.deformables[0].touch);
  }
  ASSERT_TRUE(writer.finish());
  EXPECT_EQ(errors.frames(), 200u);
  if (profile == DeformableProfile::main) {
    EXPECT_EQ(errors.all().violations, 0u);
    EXPECT_LE(errors.worst_ratio(), 1);
  }
  EXPECT_GT(errors.area().vertices, 100u) << "or nothing was touched";
  EXPECT_GT(errors.worst_ratio(), 0.9);
  EXPECT_GT(traffic.sizes.size(), 50u);
  EXPECT_GT(sent, traffic.sizes.size()) << "or the cube did not move";
  EXPECT_EQ(traffic.layers[0].packets + traffic.layers[1].packets, layered ? traffic.sizes.size() : 0u);
  EXPECT_EQ(traffic.layers[0].packets > 50, layered);

  const std::string bytes = file.str();
  auto player =
      Player::open({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, {.limits = testing::kWithThesis}).value();
  std::size_t played = 0;
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const auto tick = static_cast<std::int64_t>(k);
    for (;;) {
      const auto packet = player.play(tick);
      ASSERT_TRUE(packet) << packet.error().rule;
      if (!*packet) break;
      EXPECT_EQ((*packet)->tick, tick);
      ++played;
    }
    ASSERT_TRUE(std::ranges::equal(player.replica().displacements(0, tick), shown[k])) << k;
    ASSERT_EQ(player.replica().pose_hash(tick), poses[k]) << k;
  }
  EXPECT_EQ(played, sent);
  EXPECT_EQ(player.next_tick().value(), std::nullopt);
  EXPECT_TRUE(player.complete());
}

INSTANTIATE_TEST_SUITE_P(Profiles, TracedScene,
                         ::testing::Combine(::testing::Values(DeformableProfile::thesis, DeformableProfile::main),
                                            ::testing::Bool()));

TEST(TraceScene, SendingAllocatesNothing) {
  SheetTrace trace;
  trace.move(0);
  const SharedScene scene = scene_of(trace);
  auto sender = Sender::create(scene).value();
  auto receiver = Receiver::create(scene).value();
  FrameTruth frames(trace.info);
  DeformableErrors errors(trace.info.meshes[0].rest, {}, 3, scene->grid.position);
  std::uint64_t allocated = 0;
  for (std::int64_t tick = 0; tick < 100; tick += 2) {
    trace.move(tick);
    const std::uint64_t before = testing::allocated_bytes();
    const Truth truth = frames.of(trace.frame);
    const auto packets = sender.encode(tick, truth);
    ASSERT_TRUE(packets);
    for (const Packet& packet : *packets) ASSERT_TRUE(receiver.push(packet.number, packet.bytes));
    errors.add(trace.frame.meshes[0].displacements, receiver.replica().displacements(0, tick), truth.deformables[0].touch);
    allocated += testing::allocated_bytes() - before;
  }
  EXPECT_EQ(allocated, 0u);
}

}  // namespace
}  // namespace tactus
