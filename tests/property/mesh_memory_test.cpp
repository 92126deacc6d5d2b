// SPDX-License-Identifier: Apache-2.0
/// What a stream of deformable objects may make a receiver allocate (spec/95-security.md section 3): every conformance vector, and meshes
/// made to get the most out of a byte of the declaration.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <tactus/tactus.h>
#include <tactus/thesis/thesis.h>
#include "tests/property/allocated.h"
#include "tests/property/earned.h"

namespace tactus {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

constexpr DecodeLimits kWithThesis{.thesis = &thesis_component};

/// Parses the declaration, makes a receiver, hands it each packet.   out  deformable objects in the scene
std::size_t watch(const Bytes& bytes) {
  const std::uint64_t start = testing::allocated_bytes();
  auto reader = StreamFileReader::open(bytes, kWithThesis);
  if (!reader) return 0;
  const Scene& scene = *reader->scene();
  auto receiver = Receiver::create(reader->scene()).value();
  const std::uint64_t ready = testing::allocated_bytes();
  for (auto packet = reader->next(); packet && *packet; packet = reader->next())
    (void)receiver.push((*packet)->number, (*packet)->bytes);
  const std::uint64_t done = testing::allocated_bytes();
  EXPECT_LE(ready - start, testing::earned(static_cast<std::size_t>(reader->header_bytes()), scene));
  EXPECT_EQ(done, ready) << "packets allocate";
  return scene.deformables.size();
}

TEST(MeshMemory, OfEveryVector) {
  std::size_t objects = 0;
  for (const auto& entry : fs::recursive_directory_iterator(TACTUS_VECTORS)) {
    if (entry.path().extension() != ".tct") continue;
    SCOPED_TRACE(entry.path());
    std::ifstream in(entry.path(), std::ios::binary);
    objects += watch(Bytes{std::istreambuf_iterator<char>(in), {}});
  }
  EXPECT_GT(objects, 100U);
}

Bytes declared(SceneSpec&& spec) { return write_scene(*Scene::create(std::move(spec), kWithThesis).value()).value(); }

DeformableObject points(std::uint32_t vertices) {
  DeformableObject object;
  object.name = "m";
  for (std::uint32_t i = 0; i < vertices; ++i) object.rest.push_back({static_cast<std::int32_t>(i), 0, 0});
  return object;
}

/// Books of 60 pages, triangles on one edge whose ends have the highest numbers: every level of the hierarchy has nearly all edges
/// again. Three bytes each.
DeformableObject books(std::uint32_t number) {
  constexpr std::uint32_t kPages = 60, kVertices = kPages + 2;
  DeformableObject object = points(number * kVertices);
  for (std::uint32_t i = 0; i < number * kPages; ++i) {
    const std::uint32_t first = i / kPages * kVertices, spine = first + kPages;
    object.triangles.push_back({spine, spine + 1, first + i % kPages});
  }
  return object;
}

/// Each pair of 30 hubs has a triangle with each of 30 leaves.
DeformableObject bipartite() {
  constexpr std::uint32_t kHalf = 30;
  DeformableObject object = points(2 * kHalf);
  for (std::uint32_t hub = 0; hub < kHalf; hub += 2)
    for (std::uint32_t leaf = 0; leaf < kHalf; ++leaf) object.triangles.push_back({kHalf + hub, kHalf + hub + 1, leaf});
  return object;
}

TEST(MeshMemory, OfMeshesThatTakeMost) {
  std::vector<DeformableObject> objects{points(1),   points(1), points(1),  points(3000), points(3000), points(3000), books(50),
                                        bipartite(), points(1), points(30), points(1100), points(1),    points(3000), books(50)};
  objects[0].profile = DeformableProfile::thesis;
  objects[0].quant_bits = 12;
  objects[0].models_kept = true;
  objects[1].basis.entries.assign(3 * ModeBasis::kMaxModes, 1);
  objects[1].basis.steps.assign(ModeBasis::kMaxModes, 1);
  objects[2].layered = true;
  for (auto& at : objects[3].rest) at = {};  // copies of one vertex: each is a neighbour of the next
  objects[4].layered = true;
  for (std::uint32_t i = 0; i < 3000; ++i) objects[5].triangles.push_back({0, 1, 2});
  objects[8].spring_basis = {3, {}};
  objects[9].spring_basis = {64, {}};
  objects[10].spring_basis = {48, {0, 1, 5}};
  for (std::size_t i = 11; i < objects.size(); ++i) {
    objects[i].cluster_basis = {64, 32, {}};
    for (std::size_t v = 0; v < objects[i].rest.size(); ++v) objects[i].cluster_basis.clusters.push_back(v % 64);
  }
  for (const DeformableObject& object : objects) {
    for (const std::uint8_t span : {std::uint8_t{1}, std::uint8_t{64}}) {
      SCOPED_TRACE(&object - objects.data());
      SceneSpec spec;
      spec.baseline_span = span;
      spec.deformables.push_back(object);
      EXPECT_EQ(watch(declared(std::move(spec))), 1U);
    }
  }
}

/// Objects do not multiply one another's memory, and states are what state_bytes() counts.
TEST(MeshMemory, OfAStreamOfManyMeshes) {
  DeformableObject with_models = points(1);
  with_models.profile = DeformableProfile::thesis;
  with_models.quant_bits = 12;
  with_models.models_kept = true;
  for (const auto& [object, span] : {std::pair{with_models, std::uint8_t{16}}, {points(300), std::uint8_t{1}}}) {
    SceneSpec spec;
    spec.baseline_span = span;
    for (int i = 0; i < 255; ++i) {
      spec.deformables.push_back(object);
      spec.deformables.back().name = std::to_string(i);
    }
    const std::uint64_t states = state_bytes(spec);
    const Bytes bytes = declared(std::move(spec));
    const std::uint64_t start = testing::allocated_bytes();
    const auto reader = StreamFileReader::open(bytes, kWithThesis);
    const auto receiver = Receiver::create(reader->scene());
    ASSERT_TRUE(receiver);
    const std::uint64_t models = 4 * (254 + (std::uint64_t{1} << object.quant_bits));  // made once, then copied
    EXPECT_LE(testing::allocated_bytes() - start, 255 * (4096 + models) + 640 * bytes.size() + states) << int{span};
  }
}

}  // namespace
}  // namespace tactus
