// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/tets/tet_files.h>

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numbers>
#include <sstream>

#include "tests/unit/tet_fixture.h"

namespace tactus::sim {
namespace {

constexpr std::string_view kNode =
    "4 3 2 1\n1 0 0 0 0.5 1 7\n2 1 0 0 1.5 2 7\n\n# a comment\n3 0 1 0 2.5 3 8 # another\n4 0 0 1 3.5 4 9\n";
constexpr std::string_view kEle = "1 4 1\n1 1 2 3 4 -6\n";
constexpr std::string_view kMsh2 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n10 0 0 0\n20 1 0 0\n5 0 1 0\n7 0 0 1\n$EndNodes\n"
    "$Elements\n2\n1 2 2 0 1 10 20 5\n2 4 2 3 9 10 20 5 7\n$EndElements\n";
constexpr std::string_view kMsh4 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 5 20\n3 9 0 4\n10\n20\n5\n7\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n"
    "$Elements\n2 2 1 2\n2 1 2 1\n1 10 20 5\n3 9 4 1\n2 10 20 5 7\n$EndElements\n";

std::string replaced(std::string_view text, std::string_view from, std::string_view to) {
  std::string out(text);
  const std::size_t at = out.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return out.replace(at, from.size(), to);
}

template <class Read>
void expect_broken(const Read& read, std::string_view rule, std::size_t line, std::string_view word) {
  ASSERT_FALSE(read) << rule;
  EXPECT_EQ(read.error().error.rule, rule);
  EXPECT_EQ(read.error().line, line) << rule;
  EXPECT_EQ(read.error().detail, word.empty() ? "" : '\'' + std::string(word) + '\'') << rule;
}

TEST(TetFiles, NodeAndEleBringAttributesAndMarkers) {
  const auto file = parse_node_ele(kNode, kEle);
  ASSERT_TRUE(file) << to_string(file.error());
  EXPECT_TRUE(check(file->mesh));
  EXPECT_EQ(file->mesh.vertices[3], (Vec3{0, 0, 1}));
  EXPECT_EQ(file->mesh.tets[0], (Tet{0, 1, 2, 3}));
  EXPECT_EQ(file->vertex_attributes, (std::vector<double>{0.5, 1, 1.5, 2, 2.5, 3, 3.5, 4}));
  EXPECT_EQ(file->vertex_markers, (std::vector<std::int32_t>{7, 7, 8, 9}));
  EXPECT_EQ(file->tet_attributes, std::vector<double>{-6});
}

TEST(TetFiles, NumbersMayStartFromZero) {
  const auto file = parse_node_ele("4\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n", "1\n0 0 1 2 3");
  ASSERT_TRUE(file) << to_string(file.error());
  EXPECT_EQ(file->mesh.tets[0], (Tet{0, 1, 2, 3}));
}

TEST(TetFiles, EveryRuleOfNodeFilesNamesItsLine) {
  const auto node = [](std::string_view from, std::string_view to) { return parse_node_ele(replaced(kNode, from, to), kEle); };
  expect_broken(node("4 3 2 1", "9999999 3 2 1"), "R-TET-9", 1, "9999999");
  expect_broken(node("4 3 2 1", "999999 3 2 1"), "R-TET-10", 1, "999999");
  expect_broken(node("4 3 2 1", "5 3 2 1"), "R-TET-10", 7, "");
  expect_broken(node("4 3 2 1", "3 3 2 1"), "R-TET-13", 7, "4");
  expect_broken(node("4 3 2 1", "-4 3 2 1"), "R-TET-11", 1, "-4");
  expect_broken(node("4 3 2 1", "4 2 2 1"), "R-TET-14", 1, "2");
  expect_broken(node("4 3 2 1", "4 3 2 2"), "R-TET-9", 1, "2");
  expect_broken(node("2.5 3 8", "2.5x 3 8"), "R-TET-11", 6, "2.5x");
  expect_broken(node("2.5 3 8", "nan 3 8"), "R-TET-12", 6, "nan");
  expect_broken(node("2.5 3 8", "1e999 3 8"), "R-TET-11", 6, "1e999");
  expect_broken(node("2.5 3 8", "2.5 3"), "R-TET-13", 6, "");
  expect_broken(node("2.5 3 8", "2.5 3 8 0"), "R-TET-13", 6, "0");
  expect_broken(node("2.5 3 8", "2.5 3 99999999999"), "R-TET-11", 6, "99999999999");
  expect_broken(node("\n3 0 1", "\n5 0 1"), "R-TET-15", 6, "5");
  expect_broken(node("\n1 0 0", "\n2 0 0"), "R-TET-15", 2, "2");
  expect_broken(parse_node_ele("", kEle), "R-TET-10", 0, "");
}

TEST(TetFiles, EveryRuleOfEleFilesNamesItsLine) {
  const auto ele = [](std::string_view text) { return parse_node_ele(kNode, text); };
  expect_broken(ele("9999999 4 0\n"), "R-TET-9", 1, "9999999");
  expect_broken(ele("9 4 0\n1 1 2 3 4\n"), "R-TET-10", 1, "9");
  expect_broken(ele("1 10 0\n1 1 2 3 4 5 6 7 8 9 10\n"), "R-TET-14", 1, "10");
  expect_broken(ele("1 4 0\n1 1 2 3 5\n"), "R-TET-15", 2, "5");
  expect_broken(ele("1 4 0\n1 0 1 2 3\n"), "R-TET-15", 2, "0");
  expect_broken(ele("1 4 0\n1 1 2 3\n "), "R-TET-13", 2, "");
  expect_broken(ele("1 4 0\n1 1 2 3 4 5\n"), "R-TET-13", 2, "5");
  expect_broken(ele("0 4 0\n"), "R-TET-16", 1, "");
}

TEST(TetFiles, BothVersionsOfMshReadTheSame) {
  for (const std::string_view text : {kMsh2, kMsh4}) {
    const auto file = parse_msh(text);
    ASSERT_TRUE(file) << to_string(file.error());
    EXPECT_EQ(file->mesh.tets, std::vector{(Tet{0, 1, 2, 3})});
    EXPECT_EQ(file->mesh.vertices[1], (Vec3{1, 0, 0}));
    EXPECT_EQ(file->regions, std::vector<std::int32_t>{9});
    EXPECT_EQ(file->ignored_elements, 1U);
    EXPECT_EQ(file->ignored_vertices, 0U);
  }
}

/// `value` in its first `bytes` bytes, the highest first if `big`.
void put(std::string& out, std::uint64_t value, std::size_t bytes, bool big) {
  for (std::size_t b = 0; b < bytes; ++b) out += static_cast<char>(value >> 8 * (big ? bytes - 1 - b : b));
}

/// kMsh2 or kMsh4 as bytes.
std::string binary_msh(bool legacy, bool big) {
  const std::size_t size = legacy ? 4 : 8;
  std::string out = std::string("$MeshFormat\n") + (legacy ? "2.2" : "4.1") + " 1 8\n";
  put(out, 1, 4, big);
  out += "\n$EndMeshFormat\n$Nodes\n";
  const std::uint64_t tags[] = {10, 20, 5, 7};
  const double positions[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const auto put_position = [&](std::size_t i) {
    for (const double c : positions[i]) put(out, std::bit_cast<std::uint64_t>(c), 8, big);
  };
  if (legacy) out += "4\n";
  for (const std::uint64_t v : {1U, 4U, 5U, 20U})
    if (!legacy) put(out, v, 8, big);
  for (const std::uint64_t v : {3U, 9U, 0U})
    if (!legacy) put(out, v, 4, big);
  if (!legacy) put(out, 4, 8, big);
  for (std::size_t i = 0; i < 4; ++i) {
    put(out, tags[i], size, big);
    if (legacy) put_position(i);
  }
  for (std::size_t i = 0; i < 4 && !legacy; ++i) put_position(i);
  out += "\n$EndNodes\n$Elements\n";
  if (legacy) {
    out += "2\n";
    for (const std::uint64_t v : {2U, 1U, 2U, 1U, 0U, 1U, 10U, 20U, 5U, 4U, 1U, 2U, 2U, 3U, 9U, 10U, 20U, 5U, 7U})
      put(out, v, 4, big);
  } else {
    for (const std::uint64_t v : {2U, 2U, 1U, 2U}) put(out, v, 8, big);
    for (const std::uint64_t v : {2U, 1U, 2U}) put(out, v, 4, big);
    for (const std::uint64_t v : {1U, 1U, 10U, 20U, 5U}) put(out, v, 8, big);
    for (const std::uint64_t v : {3U, 9U, 4U}) put(out, v, 4, big);
    for (const std::uint64_t v : {1U, 2U, 10U, 20U, 5U, 7U}) put(out, v, 8, big);
  }
  return out + "\n$EndElements\n";
}

TEST(TetFiles, OtherFormsOfMshReadTheSame) {
  std::vector<std::string> files;
  for (const char* version : {"2", "2.0", "2.1"}) files.push_back(replaced(kMsh2, "2.2", version));
  files.push_back("$Comments\nby hand\n$EndComments\n" + std::string(kMsh2));
  files.push_back("\xEF\xBB\xBF" + std::string(kMsh4));
  files.push_back(
      "$MeshFormat\n4 0 8\n$EndMeshFormat\n$Nodes\n1 4\n9 3 0 4\n10 0 0 0\n20 1 0 0\n5 0 1 0\n7 0 0 1\n$EndNodes\n"
      "$Elements\n2 2\n1 2 2 1\n1 10 20 5\n9 3 4 1\n2 10 20 5 7\n$EndElements\n");
  for (const bool legacy : {true, false})
    for (const bool big : {true, false}) files.push_back(binary_msh(legacy, big));
  for (const std::string& text : files) {
    const auto file = parse_msh(text);
    ASSERT_TRUE(file) << text.substr(0, 30) << to_string(file.error());
    EXPECT_EQ(file->mesh.tets, std::vector{(Tet{0, 1, 2, 3})});
    EXPECT_EQ(file->mesh.vertices[1], (Vec3{1, 0, 0}));
    EXPECT_EQ(file->mesh.vertices[3], (Vec3{0, 0, 1}));
    EXPECT_EQ(file->regions, std::vector<std::int32_t>{9});
    EXPECT_EQ(file->ignored_elements, 1U);
  }
  for (const bool legacy : {true, false}) {
    const std::string text = binary_msh(legacy, false);
    for (std::size_t size = 0; size + 14 < text.size(); ++size) EXPECT_FALSE(parse_msh(text.substr(0, size))) << legacy << size;
  }
}

TEST(TetFiles, UnusedVerticesOfNodeFilesAreDropped) {
  const auto file =
      parse_node_ele("5 3 1 1\n1 9 9 9 4 6\n2 0 0 0 5 7\n3 1 0 0 6 8\n4 0 1 0 7 9\n5 0 0 1 8 10\n", "1 4 0\n1 2 3 4 5\n");
  ASSERT_TRUE(file) << to_string(file.error());
  EXPECT_EQ(file->ignored_vertices, 1U);
  EXPECT_EQ(file->mesh.tets[0], (Tet{0, 1, 2, 3}));
  EXPECT_EQ(file->mesh.vertices[1], (Vec3{1, 0, 0}));
  EXPECT_EQ(file->vertex_attributes, (std::vector<double>{5, 6, 7, 8}));
  EXPECT_EQ(file->vertex_markers, (std::vector<std::int32_t>{7, 8, 9, 10}));
}

TEST(TetFiles, EveryRuleOfMshNamesItsLine) {
  const auto msh = [](std::string_view text, std::string_view from, std::string_view to) {
    return parse_msh(replaced(text, from, to));
  };
  expect_broken(msh(kMsh2, "2.2 0 8", "4.0 1 8"), "R-TET-14", 2, "binary");
  expect_broken(msh(kMsh2, "2.2 0 8", "2.2 0 4"), "R-TET-14", 2, "4");
  expect_broken(msh(kMsh2, "2.2 0 8", "3.0 0 8"), "R-TET-14", 2, "3.0");
  expect_broken(msh(kMsh2, "$Nodes\n4", "$Nodes\n9999999"), "R-TET-9", 5, "9999999");
  expect_broken(msh(kMsh2, "$Nodes\n4", "$Nodes\n999"), "R-TET-10", 5, "999");
  expect_broken(msh(kMsh2, "$Nodes\n4", "$Nodes\n3"), "R-TET-13", 9, "7");
  expect_broken(msh(kMsh2, "7 0 0 1", "7 0 inf 1"), "R-TET-12", 9, "inf");
  expect_broken(msh(kMsh2, "\n7 0 0 1", "\n5 0 0 1"), "R-TET-15", 11, "5");
  expect_broken(msh(kMsh2, "20 5 7", "20 5 8"), "R-TET-15", 14, "8");
  expect_broken(msh(kMsh2, "20 5 7", "20 5"), "R-TET-13", 14, "");
  expect_broken(msh(kMsh2, "2 4 2 3 9", "2 11 2 3 9"), "R-TET-14", 14, "11");
  expect_broken(msh(kMsh2, "2 4 2 3 9", "2 2 2 3 9"), "R-TET-16", 15, "");
  expect_broken(msh(kMsh2, "$EndElements", "$EndNodes"), "R-TET-13", 15, "$EndNodes");
  expect_broken(msh(kMsh2, "$Nodes", "$Names"), "R-TET-10", 15, "");
  expect_broken(msh(kMsh4, "1 4 5 20", "2 4 5 20"), "R-TET-11", 15, "$EndNodes");
  expect_broken(msh(kMsh4, "3 9 0 4", "3 9 0 5"), "R-TET-9", 6, "5");
  expect_broken(msh(kMsh4, "3 9 0 4", "3 9 0 3"), "R-TET-13", 10, "");
  expect_broken(msh(kMsh4, "1 4 5 20", "1 5 5 20"), "R-TET-13", 14, "");
  expect_broken(msh(kMsh4, "0 0 1\n$", "0 0 1 0.5\n$"), "R-TET-13", 14, "0.5");
  expect_broken(msh(kMsh4, "2 2 1 2", "2 3 1 2"), "R-TET-13", 21, "");
  expect_broken(msh(kMsh4, "2 2 1 2", "2 1 1 2"), "R-TET-9", 20, "1");
}

TEST(TetFiles, MeshesThatGmshWroteAreSound) {
  for (const char* name : {"half-cylinder-2.2.msh", "half-cylinder-4.1.msh", "half-cylinder-4.1-parametric.msh"}) {
    const auto file = read_tet_mesh(std::string(TACTUS_TEST_DATA "/meshes/") + name);
    ASSERT_TRUE(file) << to_string(file.error());
    EXPECT_TRUE(check(file->mesh)) << to_string(check(file->mesh).error());
    EXPECT_EQ(file->mesh.vertices.size(), 18U);
    EXPECT_EQ(file->ignored_vertices, 1U);
    EXPECT_EQ(file->mesh.tets.size() + file->ignored_elements, 85U);
    const double cylinder = std::numbers::pi / 2 * 0.1 * 0.1 * 0.05;  // facets with corners on it stay below, by at most what
    EXPECT_LT(total_volume(file->mesh), cylinder);                    // four chords in the half circle lose
    EXPECT_GT(total_volume(file->mesh), 4 * 0.5 * 0.1 * 0.1 * std::sin(std::numbers::pi / 4) * 0.05);
  }
}

TEST(TetFiles, WhatIsWrittenReadsBackToTheSameBits) {
  TetMesh mesh = make_slab(2, 3, 1, 0.1);
  mesh.vertices[5].x = 0.1 + 0.2;
  mesh.vertices[6].y = -1e-300;
  std::ostringstream node, ele, msh;
  write_node(node, mesh), write_ele(ele, mesh), write_msh(msh, mesh);
  for (const auto& file : {parse_node_ele(node.str(), ele.str()), parse_msh(msh.str())}) {
    ASSERT_TRUE(file) << to_string(file.error());
    EXPECT_EQ(file->mesh.vertices, mesh.vertices);
    EXPECT_EQ(file->mesh.tets, mesh.tets);
  }
}

TEST(TetFiles, SurfacesForTetGenHaveItsForm) {
  const TriMesh triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1.5, 0}}, {{0, 1, 2}}};
  std::ostringstream smesh;
  write_smesh(smesh, triangle);
  EXPECT_EQ(smesh.str(), "3 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1.5 0\n1 0\n3 0 1 2\n0\n0\n");
}

TEST(TetFiles, EveryPrefixIsRefusedOrComplete) {
  for (const std::string_view text : {kMsh2, kMsh4})
    for (std::size_t size = 0; size < text.size() - 1; ++size) EXPECT_FALSE(parse_msh(text.substr(0, size))) << size;
  for (std::size_t size = 0; size < kNode.size() - 3; ++size) EXPECT_FALSE(parse_node_ele(kNode.substr(0, size), kEle)) << size;
}

TEST(TetFiles, FilesAreFoundBesideOneAnotherAndErrorsNameThem) {
  const TempFolder folder;
  const std::string node = folder.write("m.node", kNode), ele = folder.write("m.ele", "1 4 0\n1 1 2 3 oops\n");
  for (const std::string& path : {node, ele}) {
    const auto file = read_tet_mesh(path);
    ASSERT_FALSE(file);
    EXPECT_EQ(to_string(file.error()).find(ele + ":2: 'oops': R-TET-11: "), 0U) << to_string(file.error());
  }
  folder.write("m.ele", kEle);
  EXPECT_TRUE(read_tet_mesh(ele));
  std::filesystem::remove(node);
  const auto gone = read_tet_mesh(ele);
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().file, node);
  EXPECT_STREQ(gone.error().error.rule, "R-TET-8");
  expect_broken(read_tet_mesh(folder.write("m.vtk", "")), "R-TET-17", 0, "");
  std::filesystem::create_directory(folder.file("d.msh"));
  expect_broken(read_tet_mesh(folder.file("d.msh")), "R-TET-8", 0, "");
}

}  // namespace
}  // namespace tactus::sim
