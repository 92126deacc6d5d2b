// SPDX-License-Identifier: Apache-2.0
// From a trace's meshes to a stream and back: io/trace/mesh_link.h, mesh_fidelity.h, compare.h.
#include <tactus/metrics/deformable_link.h>

#include <gtest/gtest.h>

#include <sstream>

#include <tactus/metrics/compare.h>
#include <tactus/metrics/deformable_errors.h>
#include <tactus/packet/substream.h>
#include "tests/property/allocated.h"
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

constexpr std::uint32_t kSquares = 12;

/// A sheet with a dent as a trace would hold it, new every second tick, touched by one of two users.
class SheetTrace {
 public:
  SheetTrace() : sheet_(testing::sheet(kSquares, kSquares)), dented_(sheet_, kSquares) {
    info.meshes = {{"sheet", sheet_, {}, 2}, {"still", testing::sheet(1, 1), {}, 2}};
    info.users = {"left", "right"};
    frame.users.resize(2);
    frame.meshes = {{false, std::vector<float>(3 * sheet_.vertices.size())}, {false, std::vector<float>(12)}};
  }
  void move(std::int64_t tick) {
    frame.tick = tick;
    frame.meshes[0].updated = tick % 2 == 0;
    frame.users[0].surface_contact.reset();
    if (!frame.meshes[0].updated) return;
    const testing::SheetFrame shape = dented_.frame(tick / 2);
    float* out = frame.meshes[0].displacements.data();
    for (const Vec3& u : shape.displacement)
      for (const double c : {u.x, u.y, u.z}) *out++ = static_cast<float>(c);
    if (!shape.touch) return;
    frame.users[0].surface_contact = {0, shape.touch->triangle, {1, 0, 0}, {0, 0, shape.touch->force / 500}, {0, 0, 1}, 500};
  }

  TraceInfo info;
  TraceFrame frame;

 private:
  TriMesh sheet_;
  testing::DentedSheet dented_;
};

TEST(DeformableLink, LightestTouchCounts) {
  TraceFrame frame;
  frame.users.resize(3);
  frame.users[0].surface_contact = {0, 5, {1, 0, 0}, {0, 0, 0.003}, {0, 0, 1}, 100};
  frame.users[1].surface_contact = {0, 6, {1, 0, 0}, {0, 0, 0.002}, {0, 0, 1}, 100};
  frame.users[1].contact.device = {0, 0, 0.001};
  frame.users[2].surface_contact = {1, 7, {1, 0, 0}, {}, {0, 0, 1}, 100};
  const auto touch = touch_of(frame, 0);
  ASSERT_TRUE(touch);
  EXPECT_EQ(touch->triangle, 6u);
  EXPECT_NEAR(touch->force, 0.1, 1e-12);
  EXPECT_EQ(touch->stiffness, 100);
  EXPECT_EQ(touch_of(frame, 1)->triangle, 7u);
  EXPECT_FALSE(touch_of(frame, 2));
}

class LinkedMesh : public ::testing::TestWithParam<std::tuple<DeformableProfile, bool>> {};

TEST_P(LinkedMesh, BoundsHoldAndAPlayerShowsTheSame) {
  const auto& [profile, split] = GetParam();
  SheetTrace trace;
  trace.move(0);
  DeformableCoding coding;
  coding.profile = profile;
  coding.split = split;
  coding.basis = [](const TraceDeformable& mesh) -> Result<ModeBasis> {
    return mesh.name == "sheet" ? testing::wave_basis(mesh.rest, kSquares, 6) : ModeBasis{};
  };
  const StreamHeader header = stream_header(trace.info, trace.frame, coding).value();
  ASSERT_EQ(header.meshes.size(), 2u);
  if (profile == DeformableProfile::main) {
    EXPECT_EQ(header.meshes[0].frame_period, 512u);
    EXPECT_EQ(header.meshes[0].basis.steps.size(), 6u);
    EXPECT_EQ(header.meshes[0].split, split);
  }
  DeformableEncoderOptions options;
  options.split = split;
  DeformableLink link = DeformableLink::create(header, 0, options).value();
  DeformableErrors fidelity(trace.info.meshes[0].rest, options.thresholds, coding.rings, header.grid.position);
  DeformableRates traffic;
  PartJoiner parts(header);
  std::ostringstream file(std::ios::binary);
  auto writer = StreamFileWriter::create(file, header).value();
  std::vector<std::vector<Vec3>> shown;
  for (std::int64_t tick = 0; tick < 400; ++tick) {
    trace.move(tick);
    if (!trace.frame.meshes[0].updated) continue;
    const auto touch = touch_of(trace.frame, 0);
    const DeformablePackets packets = link.encode(tick, trace.frame.meshes[0].displacements, touch).value();
    for (const EncodedDeformablePacket& packet : packets) {
      if (packet.bytes.empty()) continue;
      ASSERT_TRUE(link.decode(packet.bytes));
      ASSERT_TRUE(writer.add(tick, parts.join(1, packet.bytes), packet.key));
      traffic.add(packet.bytes.size(), packet.updates, packet.key, packet.half);
    }
    shown.emplace_back(link.shown(tick).begin(), link.shown(tick).end());
    fidelity.add(trace.frame.meshes[0].displacements, shown.back(), touch);
  }
  ASSERT_TRUE(writer.finish());
  EXPECT_EQ(fidelity.frames(), 200u);
  if (profile == DeformableProfile::main) {
    EXPECT_EQ(fidelity.all().violations, 0u);
    EXPECT_LE(fidelity.worst_ratio(), 1);
  }
  EXPECT_GT(fidelity.area().vertices, 100u) << "or nothing was touched";
  EXPECT_GT(fidelity.worst_ratio(), 0.9);
  EXPECT_GT(traffic.sizes.size(), 50u);
  EXPECT_EQ(traffic.halves[0].packets + traffic.halves[1].packets, split ? traffic.sizes.size() : 0u);
  EXPECT_EQ(traffic.halves[0].packets > 50, split);

  const std::string bytes = file.str();
  auto player = StreamPlayer::open({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}).value();
  std::size_t packets = 0;
  for (std::size_t k = 0; k < shown.size(); ++k) {
    const auto tick = static_cast<std::int64_t>(2 * k);
    for (;;) {
      const auto played = player.play(tick);
      ASSERT_TRUE(played) << played.error().rule;
      if (!*played) break;
      EXPECT_EQ((*played)->part, 1u);
      EXPECT_EQ((*played)->tick(), tick);
      ++packets;
    }
    const auto displacements = player.displacements(0, tick);
    for (std::size_t v = 0; v < shown[k].size(); ++v)
      ASSERT_EQ(to_metres(displacements[v], header.grid.position), shown[k][v]) << k;
  }
  EXPECT_EQ(packets, traffic.sizes.size());
}

INSTANTIATE_TEST_SUITE_P(Profiles, LinkedMesh,
                         ::testing::Combine(::testing::Values(DeformableProfile::thesis, DeformableProfile::main),
                                            ::testing::Bool()));

TEST(DeformableLink, SendingAllocatesNothing) {
  SheetTrace trace;
  trace.move(0);
  const StreamHeader header = stream_header(trace.info, trace.frame).value();
  DeformableLink link = DeformableLink::create(header, 0, {}).value();
  DeformableErrors fidelity(trace.info.meshes[0].rest, {}, 3, header.grid.position);
  PartJoiner parts(header);
  std::uint64_t allocated = 0;
  for (std::int64_t tick = 0; tick < 100; tick += 2) {
    trace.move(tick);
    const std::uint64_t before = testing::allocated_bytes();
    const auto touch = touch_of(trace.frame, 0);
    const auto packets = link.encode(tick, trace.frame.meshes[0].displacements, touch).value();
    for (const EncodedDeformablePacket& packet : packets)
      if (!packet.bytes.empty() && link.decode(packet.bytes)) parts.join(1, packet.bytes);
    fidelity.add(trace.frame.meshes[0].displacements, link.shown(tick), touch);
    allocated += testing::allocated_bytes() - before;
  }
  EXPECT_EQ(allocated, 0u);
}

TEST(DeformableLink, RefusesWhatDoesNotFit) {
  SheetTrace trace;
  trace.move(0);
  const StreamHeader header = stream_header(trace.info, trace.frame).value();
  DeformableLink link = DeformableLink::create(header, 0, {}).value();
  EXPECT_STREQ(link.encode(0, std::vector<float>(9), {}).error().rule, "R-API-5");
  trace.frame.meshes[0].displacements[4] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_STREQ(link.encode(0, trace.frame.meshes[0].displacements, {}).error().rule, "R-API-1");
  EXPECT_STREQ(DeformableLink::create(header, 2, {}).error().rule, "R-API-5");
  trace.info.meshes[0].rest.vertices[3].x = 1e5;
  EXPECT_STREQ(stream_header(trace.info, trace.frame).error().rule, "R-API-2");
}

TEST(DeformableErrors, CountsByBound) {
  const TriMesh sheet = testing::sheet(8, 8);
  const DeformableThresholds bounds{.visual = 0.001, .weber_fraction = 0.1, .depth_floor = 1e-4};
  DeformableErrors fidelity(sheet, bounds, 0, 22);
  const std::vector<float> truth(3 * sheet.vertices.size());
  std::vector<Vec3> shown(sheet.vertices.size());
  const Triangle& touched = sheet.triangles[20];
  shown[touched[0]] = {0, 0, 0.0003};  // h = 0.1 * 2 mm
  shown[touched[1]] = {0, 0.0001, 0};
  shown[80] = {0.0008, 0, 0};
  fidelity.add(truth, shown, {});
  EXPECT_EQ(fidelity.all().violations, 0u);
  EXPECT_EQ(fidelity.area().vertices, 0u);
  EXPECT_NEAR(fidelity.worst_ratio(), 0.8, 1e-9);
  fidelity.add(truth, shown, SurfaceTouch{20, 0.2, 100});
  EXPECT_EQ(fidelity.all().violations, 1u);
  EXPECT_EQ(fidelity.area().vertices, 3u);
  EXPECT_EQ(fidelity.area().violations, 1u);
  EXPECT_NEAR(fidelity.area().max, 0.0003, 1e-12);
  EXPECT_NEAR(fidelity.area().mse(), (0.0003 * 0.0003 + 0.0001 * 0.0001) / 3, 1e-15);
  EXPECT_NEAR(fidelity.worst_ratio(), 1.5, 1e-9);
  EXPECT_NEAR(fidelity.mean_haptic(), 0.0002, 1e-12);
  shown[80] = {0.0011, 0, 0};
  fidelity.add(truth, shown, {});
  EXPECT_EQ(fidelity.all().violations, 2u);
  EXPECT_EQ(fidelity.all().vertices, 3 * sheet.vertices.size());
}

TEST(DeformableErrors, BoundsDoNotGoBelowTheGrid) {
  const TriMesh sheet = testing::sheet(1, 1);
  DeformableErrors fidelity(sheet, {.visual = 0, .weber_fraction = {}, .depth_floor = 0}, 3, 10);
  const std::vector<float> truth(12);
  const double half = 0.5 / 1024;
  fidelity.add(truth, std::vector<Vec3>(4, Vec3{half, half, half}), {});
  EXPECT_EQ(fidelity.all().violations, 0u);
  fidelity.add(truth, std::vector<Vec3>(4, Vec3{half, half, 1.01 * half}), {});
  EXPECT_EQ(fidelity.all().violations, 4u);
}

TEST(DeformableRates, Quantiles) {
  DeformableRates traffic;
  EXPECT_EQ(traffic.quantile(0.99), 0u);
  for (std::size_t size = 1; size <= 200; ++size) traffic.add(size, 1, size == 1, size % 2 == 0 ? Layer::haptic : Layer::all);
  EXPECT_EQ(traffic.quantile(0.99), 198u);
  EXPECT_EQ(traffic.quantile(1), 200u);
  EXPECT_EQ(traffic.keys, 1u);
  EXPECT_EQ(traffic.bytes, 20100u);
  EXPECT_EQ(traffic.halves[0].packets, 100u);
  EXPECT_EQ(traffic.halves[0].bytes, 10100u);
  EXPECT_EQ(traffic.halves[1].packets, 0u);
}

}  // namespace
}  // namespace tactus
