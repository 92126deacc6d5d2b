// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/trace_scene.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include <tactus/deformable/displacement.h>
#include <tactus/receiver.h>
#include "tests/unit/deformable_fixture.h"
#include "tests/unit/temp_file.h"

namespace tactus {
namespace {

constexpr std::uint32_t kSquares = 24;
constexpr std::int64_t kFrames = 200;
constexpr double kVisual = 5e-4;

/// A sheet that walks along y, turns, and whose outer half folds.
std::vector<float> walking(const TriMesh& rest, std::int64_t frame) {
  const double t = static_cast<double>(frame) / 30, fold = 0.8 * std::sin(2 * t), turn = 0.5 * t;
  const double hinge = rest.vertices.back().x / 2;
  std::vector<float> out;
  for (const Vec3& p : rest.vertices) {
    const double beyond = std::max(0.0, p.x - hinge), x = p.x - beyond + beyond * std::cos(fold),
                 z = p.z + beyond * std::sin(fold);
    const Vec3 q{std::cos(turn) * x - std::sin(turn) * p.y, std::sin(turn) * x + std::cos(turn) * p.y + 0.1 * t, z};
    for (const double c : {q.x - p.x, q.y - p.y, q.z - p.z}) out.push_back(static_cast<float>(c));
  }
  return out;
}

void record(const TriMesh& rest, const std::string& path) {
  TraceInfo info{.tick_rate = 30,
                 .objects = {},
                 .users = {},
                 .source = "test",
                 .scene = "",
                 .meshes = {{"walker", rest}, {"still", testing::sheet(1, 1)}}};
  auto writer = TraceWriter::create(path, info).value();
  TraceFrame frame;
  frame.meshes = {{}, {false, std::vector<float>(12)}};
  for (frame.tick = 0; frame.tick < kFrames; ++frame.tick) {
    frame.meshes[0] = {true, walking(rest, frame.tick)};
    EXPECT_TRUE(writer.write(frame));
  }
  EXPECT_TRUE(writer.finish());
}

/// Bytes of the packets; the bound is checked on what the receiver shows.
std::size_t coded(const TriMesh& rest, const ClusterBasis& clusters) {
  const auto scene = SceneBuilder(30).deformable("walker", rest, {.cluster_basis = clusters}).build().value();
  auto sender = Sender::create(scene, {.deformable = {.thresholds = {.visual = kVisual}}, .policy = {.key_interval = 0}}).value();
  auto receiver = Receiver::create(scene).value();
  std::size_t bytes = 0;
  for (std::int64_t tick = 0; tick < kFrames; ++tick) {
    const std::vector<float> shape = walking(rest, tick);
    const DeformableTruth truth{shape, {}};
    const auto packets = sender.encode(tick, {.deformables = {&truth, 1}});
    EXPECT_TRUE(packets);
    for (const Packet& packet : *packets) {
      bytes += packet.bytes.size();
      EXPECT_TRUE(receiver.push(packet.number, packet.bytes));
    }
    EXPECT_EQ(receiver.state_hash(1), sender.state_hash(1));
    const auto shown = receiver.replica().displacements(0, tick);
    for (std::size_t v = 0; v < shown.size(); ++v) {
      const Vec3 u{shape[3 * v], shape[3 * v + 1], shape[3 * v + 2]};
      EXPECT_LE(norm(u - to_metres(shown[v], scene->grid.position)), kVisual) << v << " at " << tick;
    }
  }
  return bytes;
}

TEST(TraceClusters, OfABodyThatWalksTakeHalfOfItsBits) {
  const TriMesh rest = testing::sheet(kSquares, kSquares);
  const TempFile file;
  record(rest, file.path());
  auto reader = TraceReader::open(file.path()).value();
  const auto found = find_clusters(reader, 4);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 1U) << "a mesh without a shape has no clusters";
  const ClusterBasis& clusters = found->at("walker");
  EXPECT_GE(clusters.count, 2);
  EXPECT_EQ(clusters.clusters.size(), rest.vertices.size());
  EXPECT_LT(2 * coded(rest, clusters), coded(rest, {}));
}

TEST(TraceClusters, ReportWhatIsWrong) {
  const TriMesh rest = testing::sheet(2, 2);
  const TempFile file;
  record(rest, file.path());
  auto reader = TraceReader::open(file.path()).value();
  EXPECT_STREQ(find_clusters(reader, 65).error().rule, "R-API-4");
  std::filesystem::resize_file(file.path(), std::filesystem::file_size(file.path()) / 2);
  auto cut = TraceReader::open(file.path());
  if (cut) {
    EXPECT_TRUE(find_clusters(*cut, 2)) << "what is whole is used";
  }
}

}  // namespace
}  // namespace tactus
