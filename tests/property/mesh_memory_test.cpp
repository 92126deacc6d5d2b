// SPDX-License-Identifier: Apache-2.0
/// What a stream of meshes may make a decoder allocate (spec/60-mesh.md section 10): every conformance vector, and meshes made to get
/// the most out of a byte of header.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include <tactus/tactus.h>
#include "tests/property/allocated.h"
#include "tests/property/earned.h"

namespace tactus {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;
using testing::earned;

/// Parses the header, makes a decoder of each mesh, hands each packet to its decoder. Returns how many there are.
std::size_t watch(const Bytes& bytes) {
  const std::uint64_t start = testing::allocated_bytes();
  auto reader = StreamFileReader::open(bytes);
  if (!reader) return 0;
  const std::uint64_t parsing = testing::allocated_bytes() - start;
  const StreamHeader& header = reader->header();
  const std::size_t header_bytes = static_cast<std::size_t>(reader->position());
  std::vector<DeformableDecoder> decoders;
  decoders.reserve(header.meshes.size());
  for (std::size_t i = 0; i < header.meshes.size(); ++i) {
    const std::uint64_t before = testing::allocated_bytes();
    decoders.push_back(DeformableDecoder::create(header, i).value());
    EXPECT_LE(parsing + testing::allocated_bytes() - before, earned(header_bytes, header.baseline_span, header.meshes[i])) << i;
  }
  const std::uint64_t ready = testing::allocated_bytes();
  for (auto packet = reader->next(); packet && *packet; packet = reader->next()) {
    const auto part = split_part(header, (*packet)->bytes);
    if (!part) continue;
    const bool rigid = has_part_byte(header) ? part->part == 0 : header.meshes.empty();
    if (!rigid) (void)decoders[has_part_byte(header) ? part->part - 1 : 0].decode(part->bytes);
  }
  EXPECT_EQ(testing::allocated_bytes(), ready) << "packets allocate";
  return decoders.size();
}

TEST(MeshMemory, OfEveryVector) {
  std::size_t decoders = 0;
  for (const auto& entry : fs::recursive_directory_iterator(TACTUS_VECTORS)) {
    if (entry.path().extension() != ".tct") continue;
    SCOPED_TRACE(entry.path());
    std::ifstream in(entry.path(), std::ios::binary);
    decoders += watch(Bytes{std::istreambuf_iterator<char>(in), {}});
  }
  EXPECT_GT(decoders, 100U);
}

/// Everything that a stream makes its decoders allocate together, for a header of so many bytes: what the header earns, and its states.
std::uint64_t watch_all(const StreamHeader& header, std::size_t bytes) {
  const auto file = write_header(header).value();
  EXPECT_EQ(file.size(), bytes);
  const std::uint64_t start = testing::allocated_bytes();
  auto reader = StreamFileReader::open(file);
  auto rigid = RigidDecoder::create(reader->header());
  std::vector<DeformableDecoder> decoders;
  decoders.reserve(header.meshes.size());
  for (std::size_t i = 0; i < header.meshes.size(); ++i)
    decoders.push_back(DeformableDecoder::create(reader->header(), i).value());
  return testing::allocated_bytes() - start;
}

DeformableObject points(std::uint32_t vertices) {
  DeformableObject mesh;
  mesh.name = "m";
  for (std::uint32_t i = 0; i < vertices; ++i) mesh.rest.push_back({static_cast<std::int32_t>(i), 0, 0});
  return mesh;
}

/// Books of 60 pages, triangles on one edge whose ends have the highest numbers: every level of the hierarchy has nearly all edges
/// again. Three bytes each.
DeformableObject books(std::uint32_t number) {
  constexpr std::uint32_t kPages = 60, kVertices = kPages + 2;
  DeformableObject mesh = points(number * kVertices);
  for (std::uint32_t i = 0; i < number * kPages; ++i) {
    const std::uint32_t first = i / kPages * kVertices, spine = first + kPages;
    mesh.triangles.push_back({spine, spine + 1, first + i % kPages});
  }
  return mesh;
}

/// Each pair of 30 hubs has a triangle with each of 30 leaves.
DeformableObject bipartite() {
  constexpr std::uint32_t kHalf = 30;
  DeformableObject mesh = points(2 * kHalf);
  for (std::uint32_t hub = 0; hub < kHalf; hub += 2)
    for (std::uint32_t leaf = 0; leaf < kHalf; ++leaf) mesh.triangles.push_back({kHalf + hub, kHalf + hub + 1, leaf});
  return mesh;
}

TEST(MeshMemory, OfMeshesThatTakeMost) {
  std::vector<DeformableObject> meshes{points(1),    points(1),    points(1), points(3000),
                                       points(3000), points(3000), books(50), bipartite()};
  meshes[0].profile = DeformableProfile::thesis;
  meshes[0].quant_bits = 12;
  meshes[0].models_kept = true;
  meshes[1].basis.entries.assign(3 * ModeBasis::kMaxModes, 1);
  meshes[1].basis.steps.assign(ModeBasis::kMaxModes, 1);
  meshes[2].split = true;
  for (auto& at : meshes[3].rest) at = {};  // copies of one vertex: each is a neighbour of the next
  meshes[4].split = true;
  for (std::uint32_t i = 0; i < 3000; ++i) meshes[5].triangles.push_back({0, 1, 2});
  for (const DeformableObject& mesh : meshes) {
    for (const std::uint8_t span : {std::uint8_t{1}, std::uint8_t{64}}) {
      SCOPED_TRACE(&mesh - meshes.data());
      StreamHeader header;
      header.baseline_span = span;
      header.meshes.push_back(mesh);
      EXPECT_EQ(watch(write_header(header).value()), 1U);
    }
  }
}

/// Meshes do not multiply one another's memory, and states are what state_bytes() counts.
TEST(MeshMemory, OfAStreamOfManyMeshes) {
  DeformableObject with_models = points(1);
  with_models.profile = DeformableProfile::thesis;
  with_models.quant_bits = 12;
  with_models.models_kept = true;
  for (const auto& [mesh, span] : {std::pair{with_models, std::uint8_t{16}}, {points(300), std::uint8_t{1}}}) {
    StreamHeader header;
    header.baseline_span = span;
    for (int i = 0; i < 255; ++i) {
      header.meshes.push_back(mesh);
      header.meshes.back().name = std::to_string(i);
    }
    const std::size_t bytes = write_header(header)->size();
    const std::uint64_t models = 4 * (254 + (std::uint64_t{1} << mesh.quant_bits));  // made once, then copied
    const std::uint64_t bound = 255 * (4096 + models) + 640 * bytes + state_bytes(header);
    EXPECT_LE(watch_all(header, bytes), bound) << int{span};
  }
}

}  // namespace
}  // namespace tactus
