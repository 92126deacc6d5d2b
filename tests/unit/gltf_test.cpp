// SPDX-License-Identifier: Apache-2.0
// Scenes with right shapes and motions: tests/tools/gltf_check.py. Here: what a reader of untrusted bytes must stand.
#include <tactus/sim/surface/gltf_scene.h>

#include <gtest/gtest.h>

#include <cstring>

namespace tactus::sim {
namespace {

/// A triangle whose buffer holds three corners and, behind them, the times 0 and 1 and two translations.
constexpr std::string_view kScene = R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"children":[1]},{}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},{"bufferView":1,"componentType":5126,"count":2,"type":"SCALAR"},
{"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":8},{"buffer":0,"byteOffset":44,"byteLength":24}],
"animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}],"samplers":[{"input":1,"output":2}]}],
"buffers":[{"byteLength":68}]})";

void append(std::string& out, std::uint32_t value) { out.append(reinterpret_cast<const char*>(&value), 4); }

std::string glb(std::string json) {
  constexpr float kData[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0};
  json.append((4 - json.size() % 4) % 4, ' ');
  std::string out = "glTF";
  append(out, 2);
  append(out, static_cast<std::uint32_t>(28 + json.size() + sizeof kData));
  append(out, static_cast<std::uint32_t>(json.size()));
  out += "JSON" + json;
  append(out, sizeof kData);
  out += std::string("BIN\0", 4) + std::string(reinterpret_cast<const char*>(kData), sizeof kData);
  return out;
}

tl::expected<GltfScene, Diagnostic> open(std::string bytes) {
  return GltfScene::open(std::move(bytes), "",
                         {.node = {}, .animation = {}, .moves = true, .drop_degenerate = false, .axes = Axes::z_up});
}

std::string with(std::string_view from, std::string_view to) {
  std::string json(kScene);
  const std::size_t at = json.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return glb(json.replace(at, from.size(), to));
}

/// Rule and location.
std::string fault(std::string bytes) {
  const auto scene = open(std::move(bytes));
  return scene ? "" : scene.error().error.rule + (' ' + scene.error().detail);
}
std::string fault(std::string_view from, std::string_view to) { return fault(with(from, to)); }

TEST(Gltf, ATriangleMoves) {
  const auto scene = open(glb(std::string(kScene)));
  ASSERT_TRUE(scene) << to_string(scene.error());
  EXPECT_EQ(scene->duration(), 1);
  EXPECT_EQ(scene->positions(0.25), (std::vector<Vec3>{{0.25, 0, 0}, {1.25, 0, 0}, {0.25, 1, 0}}));
}

TEST(Gltf, ReferencesAreThere) {
  EXPECT_EQ(fault(R"("mesh":0)", R"("mesh":7)"), "R-SRF-4 nodes[0].mesh: no meshes[7]");
  EXPECT_EQ(fault(R"("POSITION":0)", R"("POSITION":-1)"), "R-SRF-4 meshes[0].POSITION: not a whole number from 0");
  EXPECT_EQ(fault(R"("nodes":[0])", R"("nodes":[0,0])"), "R-SRF-4 scenes: nodes[0] hangs on another, or is there twice");
  EXPECT_EQ(fault(R"("children":[1])", R"("children":[1,1])"), "R-SRF-4 nodes: nodes[1] hangs on two others, or on one twice");
  EXPECT_EQ(fault(R"({}],)", R"({},{"children":[3]},{"children":[2]}],)"), "R-SRF-4 nodes hang on one another in a ring");
  EXPECT_EQ(fault(R"("buffer":0,"byteLength":36)", R"("buffer":0,"byteLength":69)"),
            "R-SRF-5 bufferViews[0].byteLength: it ends behind its buffer");
  EXPECT_EQ(fault(R"("count":3)", R"("count":4)"), "R-SRF-5 accessors[0]: it ends behind its view");
  EXPECT_EQ(fault(R"("count":3)", R"("byteOffset":18446744073709551615,"count":3)"),
            "R-SRF-5 accessors[0]: it ends behind its view");
  EXPECT_EQ(fault(R"("buffers":[{"byteLength":68}])", R"("buffers":[{"byteLength":69}])"),
            "R-SRF-5 buffers[0].byteLength: 69, but there are 68 bytes");
}

TEST(Gltf, NothingIsReservedThatIsNotThere) {
  EXPECT_EQ(fault(R"("count":3)", R"("count":9000000)"), "R-SRF-5 accessors[0]: it ends behind its view");
  EXPECT_EQ(fault(R"("count":3)", R"("count":9000000000000)"), "R-SEQ-7 accessors[0]: 9000000000000 elements");
  EXPECT_EQ(fault(R"("bufferView":0,"componentType":5126,"count":3)", R"("componentType":5126,"count":9000000)"),
            "R-SRF-2 more than 2^20 vertices");
  EXPECT_EQ(fault(R"("bufferView":0,"componentType":5126,"count":3)", R"("componentType":5126,"count":19000000)"),
            "R-SEQ-7 accessors[0]: 19000000 elements");
  EXPECT_EQ(fault(std::string(1000, '[')).substr(0, 7), "R-SRF-2");
  EXPECT_EQ(fault(R"({"asset":{"version":"2.0"},"extras":)" + std::string(100000, '[') + std::string(100000, ']') + '}'),
            "R-SRF-2 its JSON is nested more than 64 deep");
  std::string many = R"({"asset":{"version":"2.0"},"extras":[0)";
  for (int i = 0; i < (1 << 21); ++i) many += ",0";
  EXPECT_EQ(fault(many + "]}"), "R-SRF-2 its JSON has more than 2^21 values");
}

TEST(Gltf, WhatCannotBeReadIsNamed) {
  EXPECT_EQ(fault(R"("version":"2.0")", R"("version":"1.0")"), "R-SRF-3 asset.version: '1.0', not 2.0");
  EXPECT_EQ(fault(R"("asset")", R"("extensionsRequired":["EXT_meshopt_compression"],"asset")"),
            "R-SRF-3 extensionsRequired: EXT_meshopt_compression");
  EXPECT_EQ(fault(R"({"byteLength":68})", R"({"byteLength":68,"uri":"data:;base64,!!!!"})"),
            "R-SRF-4 buffers[0].uri: not data in base64");
  EXPECT_EQ(fault(R"({"byteLength":68})", R"({"byteLength":68,"uri":"a.bin"})"),
            "R-SRF-3 buffer 'a.bin': not a file in the folder of the scene");
  EXPECT_EQ(fault(R"("type":"SCALAR")", R"("type":"VEC2")"), "R-SRF-4 accessors[1]: elements of 2 numbers, not 1");
  EXPECT_EQ(fault(R"({"mesh":0,)", R"({"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],)"),
            "R-SRF-4 the animation of nodes[0]: the node has a matrix, which nothing can move");
  EXPECT_EQ(fault(R"("version":"2.0")", R"("version":1)"), "R-SRF-3 asset.version: '1', not 2.0");
  EXPECT_EQ(fault(R"("attributes")", R"("mode":1,"attributes")"), "R-SRF-7 no primitive of triangles in the scene");
  EXPECT_EQ(fault("{}").substr(0, 7), "R-SRF-3");
  EXPECT_EQ(fault("").substr(0, 7), "R-SRF-4");
}

/// Whatever bytes are missing or changed: an error, or a mesh that can be asked for its positions.
TEST(Gltf, DamagedBytes) {
  const std::string whole = glb(std::string(kScene));
  const auto survive = [](const std::string& bytes) {
    if (const auto scene = open(bytes)) {
      EXPECT_EQ(scene->positions(0.5).size(), scene->rest().mesh.vertices.size());
    }
  };
  for (std::size_t size = 0; size < whole.size(); ++size) survive(whole.substr(0, size));
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const int change : {1, 0x10, 0x80}) {
      std::string bytes = whole;
      bytes[at] = static_cast<char>(bytes[at] ^ change);
      survive(bytes);
    }
  }
}

}  // namespace
}  // namespace tactus::sim
