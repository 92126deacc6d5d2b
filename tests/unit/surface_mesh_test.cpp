// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/surface/surface_file.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <iomanip>
#include <numbers>
#include <sstream>

#include "tests/unit/tet_fixture.h"

namespace tactus::sim {
namespace {

constexpr std::string_view kObj =
    "# a tetrahedron\nmtllib ../../secret.mtl\nv 0 0 0\nv 1 0 0 0.5 0.5 0.5\nv 0 1.25 0\nvt 0 0\nvn 0 0 1\nv 0 0 1\nusemtl gold\n"
    "f 1/1/1 3//1 2/1\nf -4 -3 -1\nf 2 3 \\\n 4 # side\nf 1 4 3\n";
constexpr std::string_view kOff =
    "OFF # comment\n# another\n4 4\n6\n0 0 0\n1 0 0\n0 1.25 0\n0 0 1\n3 0 2 1 255 0 0\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
constexpr std::string_view kPly =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
    "property uchar red\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1\n1 0 0 1\n0 1.25 0 1\n0 0 1 "
    "1\n"
    "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";

/// Facets of the same tetrahedron, three corners each.
constexpr float kCorners[4][9] = {{0, 0, 0, 0, 1.25F, 0, 1, 0, 0},
                                  {0, 0, 0, 1, 0, 0, 0, 0, 1},
                                  {1, 0, 0, 0, 1.25F, 0, 0, 0, 1},
                                  {0, 0, 0, 0, 0, 1, 0, 1.25F, 0}};

std::string ascii_stl() {
  std::string text = "solid t\n";
  for (const auto& c : kCorners) {
    text += "facet normal 0 0 1\nouter loop\n";
    for (int i = 0; i < 9; i += 3)
      text += "vertex " + std::to_string(c[i]) + ' ' + std::to_string(c[i + 1]) + ' ' + std::to_string(c[i + 2]) + '\n';
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid t\n";
}

std::string binary_stl() {
  std::string text(80, ' ');
  text += std::string("\4\0\0\0", 4);
  for (const auto& c : kCorners) {
    text.append(12, '\0');
    text.append(reinterpret_cast<const char*>(c), sizeof c);
    text.append(2, '\0');
  }
  return text;
}

std::string replaced(std::string_view text, std::string_view from, std::string_view to) {
  std::string out(text);
  const std::size_t at = out.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return out.replace(at, from.size(), to);
}

double enclosed(const TriMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) sum += dot(cross(mesh.vertices[a], mesh.vertices[b]), mesh.vertices[c]) / 6;
  return sum;
}

void expect_broken(const tl::expected<SurfaceFile, Diagnostic>& file, std::string_view rule, std::string_view detail) {
  ASSERT_FALSE(file) << rule;
  EXPECT_EQ(file.error().error.rule, rule) << to_string(file.error());
  EXPECT_EQ(file.error().detail, detail);
  EXPECT_NE(to_string(file.error()).find(std::string(rule) + ": "), std::string::npos);
}

template <class T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// With a colour at each vertex and a quality at each face, as scanners' programs write them.
std::string binary_ply() {
  std::string text =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty "
      "uchar red\n"
      "element face 4\nproperty list uchar int vertex_indices\nproperty float quality\nend_header\n";
  for (const auto& v :
       {std::array{0.F, 0.F, 0.F}, std::array{1.F, 0.F, 0.F}, std::array{0.F, 1.25F, 0.F}, std::array{0.F, 0.F, 1.F}}) {
    for (const float x : v) append(text, x);
    append(text, std::uint8_t{200});
  }
  for (const auto& t : {Triangle{0, 2, 1}, Triangle{0, 1, 3}, Triangle{1, 2, 3}, Triangle{0, 3, 2}}) {
    append(text, std::uint8_t{3});
    for (const std::uint32_t v : t) append(text, v);
    append(text, 0.5F);
  }
  return text;
}

TEST(SurfaceFile, AllFormatsBringTheSameTetrahedron) {
  const std::pair<std::string, std::string> files[] = {{".obj", std::string(kObj)}, {".off", std::string(kOff)},
                                                       {".ply", std::string(kPly)}, {".ply", binary_ply()},
                                                       {".stl", ascii_stl()},       {".stl", binary_stl()}};
  for (const auto& [format, text] : files) {
    const auto file = parse_surface(text, format);
    ASSERT_TRUE(file) << text.substr(0, 80) << to_string(file.error());
    EXPECT_EQ(file->mesh.vertices.size(), 4U) << format;
    EXPECT_EQ(file->mesh.triangles.size(), 4U) << format;
    EXPECT_EQ(enclosed(file->mesh), 1.25 / 6) << format;
  }
}

TEST(SurfaceFile, PolygonsAreCutWhereTheyCanBe) {
  // A dart: from its tip at (0, 0) and its notch at (1, 1) all of it is seen, from the others not.
  const auto dart = parse_surface("v 3 0 0\nv 1 1 0\nv 0 3 0\nv 0 0 0\nv 9 9 9\nf 1 2 3 4\n", ".obj");
  ASSERT_TRUE(dart) << to_string(dart.error());
  EXPECT_EQ(dart->polygons, 1U);
  EXPECT_EQ(dart->unused_vertices, 1U);
  EXPECT_EQ(dart->mesh.triangles.size(), 2U);
  for (const auto& [a, b, c] : dart->mesh.triangles) {
    const auto& v = dart->mesh.vertices;
    EXPECT_EQ(cross(v[b] - v[a], v[c] - v[a]).z, 3);
  }
}

/// An OBJ of one polygon in the plane that x and y span in `plane`.
std::string polygon_of(const std::vector<std::array<double, 2>>& corners, const std::function<Vec3(double, double)>& plane) {
  std::ostringstream text;
  text << std::setprecision(17);
  for (const auto& [x, y] : corners) {
    const Vec3 p = plane(x, y);
    text << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
  }
  text << 'f';
  for (std::size_t i = 1; i <= corners.size(); ++i) text << ' ' << i;
  text << '\n';
  return text.str();
}

TEST(SurfaceFile, PolygonsThatAreNotConvexAreCutByTheirEars) {
  struct Case {
    const char* name;
    std::vector<std::array<double, 2>> corners;
    double area;
  };
  std::vector<std::array<double, 2>> star, spiral;
  for (int i = 0; i < 200; ++i) {
    const double angle = 2 * std::numbers::pi * i / 200, r = i % 2 == 0 ? 1 : 0.3;
    star.push_back({r * std::cos(angle), r * std::sin(angle)});
  }
  for (int i = 0; i < 60; ++i) spiral.push_back({(1 + 0.1 * i) * std::cos(0.3 * i), (1 + 0.1 * i) * std::sin(0.3 * i)});
  for (int i = 59; i >= 0; --i) spiral.push_back({(0.5 + 0.1 * i) * std::cos(0.3 * i), (0.5 + 0.1 * i) * std::sin(0.3 * i)});
  std::ranges::reverse(spiral);
  const auto area_of = [](const auto& corners) {
    double twice = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const auto &a = corners[i], &b = corners[(i + 1) % corners.size()];
      twice += a[0] * b[1] - b[0] * a[1];
    }
    return std::abs(twice) / 2;
  };
  const std::vector<Case> cases{
      {"comb, no corner sees both gaps", {{0, 0}, {5, 0}, {5, 2}, {4, 2}, {4, 1}, {1, 1}, {1, 2}, {0, 2}}, 7},
      {"corners on straight edges", {{0, 0}, {1, 0}, {2, 0}, {2, 2}, {1, 2}, {1, 1}, {0, 1}, {0, 0.5}}, 3},
      {"a hole, with a bridge to it", {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}}, 12},
      {"star", star, area_of(star)},
      {"spiral", spiral, area_of(spiral)}};
  const std::function<Vec3(double, double)> planes[] = {[](double x, double y) {
                                                          return Vec3{x, y, 7};
                                                        },
                                                        [](double x, double y) {
                                                          return Vec3{y, x, 7};
                                                        },
                                                        [](double x, double y) {
                                                          return Vec3{-3, x, y};
                                                        },
                                                        [](double x, double y) {
                                                          return Vec3{x, 0.2 * x + 5, -y};
                                                        },
                                                        [](double x, double y) {
                                                          return Vec3{x + 1e5, y - 2e5, 0.5 * x - y};
                                                        }};
  for (const Case& c : cases)
    for (const auto& plane : planes) {
      const auto file = parse_surface(polygon_of(c.corners, plane), ".obj");
      ASSERT_TRUE(file) << c.name << ": " << to_string(file.error());
      EXPECT_EQ(file->mesh.triangles.size(), c.corners.size() - 2) << c.name;
      const Vec3 along = cross(plane(1, 0) - plane(0, 0), plane(0, 1) - plane(0, 0));
      double area = 0, sign = 0;
      for (const auto& [i, j, k] : file->mesh.triangles) {
        const auto& v = file->mesh.vertices;
        const double part = dot(cross(v[j] - v[i], v[k] - v[i]), along) / (2 * dot(along, along));
        if (sign == 0) sign = part;
        EXPECT_GT(part * sign, 0) << c.name;  // all face one way: none overlap
        area += std::abs(part);
      }
      EXPECT_NEAR(area, c.area, 1e-6) << c.name;
    }
}

TEST(SurfaceFile, APolygonThatCrossesItselfIsNamedWithThePosition) {
  expect_broken(parse_surface("v 0 0 0\nv 2 0 0\nv 0 2 0\nv 3 2 0\nf 1 2 3 4\n", ".obj"), "R-SRF-6",
                "its edges 2 to 3 and 4 to 1 cross");
  expect_broken(parse_surface("OFF\n5 1 0\n0 3 0\n2 -3 0\n-3 1 0\n3 1 0\n-2 -3 0\n5 0 1 2 3 4\n", ".off"), "R-SRF-6",
                "its edges 0 to 1 and 2 to 3 cross");
}

/// Two tetrahedra that touch at a corner, and a third one at another corner of the second.
TEST(SurfaceFile, PartsThatTouchAtAPointAreSplitThere) {
  const std::string text =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv -1 0 0\nv 0 -1 0\nv 0 0 -1\nv -2 0 0\nv -1 -1 0\nv -1 0 -1\n"
      "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
      "f 1 5 6\nf 1 7 5\nf 5 7 6\nf 1 6 7\n"
      "f 5 8 9\nf 5 10 8\nf 8 10 9\nf 5 9 10\n";
  const auto file = parse_surface(text, ".obj");
  ASSERT_TRUE(file) << to_string(file.error());
  EXPECT_EQ(file->mesh.vertices.size(), 12U);
  EXPECT_EQ(file->vertex.size(), 12U);
  EXPECT_EQ(file->vertex[10] + file->vertex[11], 4U);  // copies of the first and the fifth vertex of the file
  EXPECT_EQ(file->unused_vertices, 0U);
  for (std::size_t v = 0; v < 12; ++v) EXPECT_EQ(file->mesh.vertices[v], file->mesh.vertices[file->vertex[v]]);
  for (std::size_t i = 0; i < 12; ++i)  // each tetrahedron has its own four
    for (std::size_t k = 0; k < 12; ++k)
      for (const std::uint32_t a : file->mesh.triangles[i])
        for (const std::uint32_t b : file->mesh.triangles[k]) EXPECT_FALSE(i / 4 != k / 4 && a == b);
  ASSERT_EQ(file->notes.all().size(), 1U);
  EXPECT_EQ(file->notes.all()[0].what, "one that joins parts of the surface at a point alone is split: each part has its own");
  EXPECT_EQ(file->notes.all()[0].first, "vertex 1");
  EXPECT_EQ(file->notes.all()[0].count, 2U);
}

TEST(SurfaceFile, WhatIsAnnouncedMustBeThere) {
  expect_broken(parse_surface(replaced(kOff, "4 4\n6", "2000000 4\n6"), ".off"), "R-SRF-2", "2000000 vertices, 4 faces");
  expect_broken(parse_surface(replaced(kOff, "4 4\n6", "4 900000 6"), ".off"), "R-SRF-5",
                "the file is shorter than its header says");
  expect_broken(parse_surface(replaced(kOff, "OFF", "OFF BINARY"), ".off"), "R-SRF-3", "binary");
  expect_broken(parse_surface(replaced(kOff, "1.25", "nan"), ".off"), "R-SRF-8", "(0 nan 0)");
  expect_broken(parse_surface(replaced(kPly, "vertex 4", "vertex 900000"), ".ply"), "R-SRF-5",
                "the file is shorter than its header says");
  EXPECT_TRUE(parse_surface(replaced(kPly, "list uchar", "list uint"), ".ply"));
  expect_broken(parse_surface(replaced(kPly, "double z", "real z"), ".ply"), "R-SRF-4", "'property real z'");
  expect_broken(parse_surface(replaced(kPly, "end_header", "header_end"), ".ply"), "R-SRF-4", "'header_end'");
  expect_broken(parse_surface(replaced(kObj, "1.25", "1,25"), ".obj"), "R-SRF-4", "'v 0 1,25 0'");
  expect_broken(parse_surface(replaced(kObj, "f 1 4 3", "f 1 4"), ".obj"), "R-SRF-4", "'f 1 4'");
  expect_broken(parse_surface("v 0 0 0\n", ".obj"), "R-SRF-7", "1 vertices");
  expect_broken(parse_surface(replaced(ascii_stl(), "1.250000", "inf"), ".stl"), "R-SRF-4", "'vertex 0.000000 inf 0.000000'");
  expect_broken(parse_surface(replaced(kOff, "3 0 1 3", "9 0 1 3"), ".off"), "R-SRF-4", "'9 0 1 3': a face of 9 corners");
  expect_broken(parse_surface(replaced(kPly, "3 1 2 3", "4 1 2 3"), ".ply"), "R-SRF-4", "'4 1 2 3': not a whole number");
  expect_broken(parse_surface(replaced(kPly, "ascii 1.0", "ascii h1.0"), ".ply"), "R-SRF-4", "'format ascii h1.0'");
  EXPECT_TRUE(parse_surface(replaced(kPly, "double z", "int z"), ".ply"));
  std::string bits = binary_stl();
  std::memset(bits.data() + 84 + 50 + 12, 0xff, 4);
  expect_broken(parse_surface(bits, ".stl"), "R-SRF-4", "facet 1: a corner is not finite");
  expect_broken(parse_surface(kObj, ".x3d"), "R-SRF-3", ".x3d");
}

TEST(SurfaceFile, WhatCannotBeUsedIsNamed) {
  std::string flat = binary_stl();
  std::memcpy(flat.data() + 84 + 12, flat.data() + 84 + 24, 12);  // two corners of facet 0 at one position
  expect_broken(parse_surface(flat, ".stl"), "R-SRF-10", "corners (0 1.25 0) (0 1.25 0) (1 0 0)");
  const auto index = parse_surface(replaced(kPly, "3 0 3 2", "3 0 3 9"), ".ply");
  ASSERT_FALSE(index);
  EXPECT_EQ(to_string(index.error()).find(":19: face 3: no vertex 9 among 4: R-SRF-9: "), 0U) << to_string(index.error());
}

TEST(SurfaceFile, BrokenMeshesNameTheirTriangle) {
  const auto turned = parse_surface(replaced(kOff, "3 0 3 2", "3 0 2 3"), ".off");
  ASSERT_FALSE(turned);
  EXPECT_EQ(to_string(turned.error()).find(":12: face 3: vertices 0 2 3: R-SRF-12: "), 0U) << to_string(turned.error());
}

TEST(SurfaceFile, EveryPrefixIsRefused) {
  for (const auto& [format, text] : std::initializer_list<std::pair<std::string_view, std::string>>{
           {".off", std::string(kOff)}, {".ply", std::string(kPly)}, {".ply", binary_ply()}, {".stl", binary_stl()}})
    for (std::size_t size = 0; size < text.size() - 1; ++size)
      EXPECT_FALSE(parse_surface(text.substr(0, size), format)) << format << size;
}

TEST(SurfaceFile, WrittenSurfacesReadBack) {
  const TempFolder folder;
  const TriMesh mesh = surface(make_slab(3, 2, 1, 0.25)).mesh;  // quarters are exact in single precision
  for (const char* name : {"s.obj", "s.ply", "s.OFF", "s.stl"}) {
    ASSERT_TRUE(write_surface(folder.file(name), mesh)) << name;
    const auto file = read_surface(folder.file(name));
    ASSERT_TRUE(file) << to_string(file.error());
    EXPECT_EQ(file->mesh.triangles.size(), mesh.triangles.size());
    EXPECT_EQ(file->mesh.vertices.size(), mesh.vertices.size());
    EXPECT_EQ(enclosed(file->mesh), enclosed(mesh)) << name;
  }
  TriMesh far = mesh;
  for (Vec3& v : far.vertices) v = 0.01 * v + Vec3{500000.1234, 0, 0};
  for (const char* name : {"far.obj", "far.ply", "far.off"}) {  // to the last bit
    ASSERT_TRUE(write_surface(folder.file(name), far)) << name;
    EXPECT_EQ(read_surface(folder.file(name))->mesh.vertices, far.vertices) << name;
  }
  EXPECT_FALSE(write_surface(folder.file("s.x3d"), mesh));
  const auto missing = read_surface(folder.file("gone.obj"));
  ASSERT_FALSE(missing);
  EXPECT_EQ(to_string(missing.error()).find(folder.file("gone.obj") + ": R-SRF-1: "), 0U);
  EXPECT_FALSE(write_surface(folder.file("no/folder.obj"), mesh));
}

std::string cube(std::string_view head, std::string_view face, std::string_view tail = "", std::string_view end = "\n") {
  std::string text(head);
  for (const char* v : {"0 0 0", "1 0 0", "0 1.25 0", "0 0 1"}) text.append(v).append(tail).append(end);
  for (const char* f : {"0 2 1", "0 1 3", "1 2 3", "0 3 2"}) text.append(face).append(f).append(end);
  return text;
}

void expect_tetrahedron(const std::string& text, std::string_view format) {
  const auto file = parse_surface(text, format);
  ASSERT_TRUE(file) << text.substr(0, 60) << to_string(file.error());
  EXPECT_EQ(file->mesh.vertices.size(), 4U) << text.substr(0, 60);
  EXPECT_EQ(file->mesh.triangles.size(), 4U) << text.substr(0, 60);
  EXPECT_EQ(enclosed(file->mesh), 1.25 / 6) << text.substr(0, 60);
}

TEST(SurfaceFile, DialectsOfOffReadTheSame) {
  for (const char* head :
       {"OFF4 4 0\n", "OFF4 4 6\n", "OFF\n4 4\n", "\n # front\n\nOFF\n# c\n4 4 0\n", "4 4 0\n", "OFF 4\n4\n6\n"})
    expect_tetrahedron(cube(head, "3 "), ".off");
  expect_tetrahedron(cube("COFF\n4 4 0\n", "3 ", " 255 0 0 255"), ".off");
  expect_tetrahedron(cube("NOFF\n4 4 0\n", "3 ", " 0 0 1"), ".off");
  expect_tetrahedron(cube("STCNOFF\n4 4 0\n", "3 ", " 0 0 1 1 1 1 0.5 0.5"), ".off");
  expect_tetrahedron(cube("OFF 4 4 0 ", "3 ", "", " "), ".off");
  expect_tetrahedron(cube("COFF\n4 4 0\n", "3 ", " 1 0 0", " "), ".off");
  for (const char* head : {"4OFF\n4 4 0\n", "nOFF\n4 4 0\n"}) {
    const auto refused = parse_surface(cube(head, "3 ", " 1"), ".off");
    ASSERT_FALSE(refused);
    EXPECT_STREQ(refused.error().error.rule, "R-SRF-3");
  }
}

TEST(SurfaceFile, TextOfAnySystemReadsTheSame) {
  const auto ending = [](std::string text, std::string_view end) {
    for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += end.size()) text.replace(at, 1, end);
    return text;
  };
  const auto wide = [](const std::string& text) {
    std::string out = "\xFF\xFE";
    for (const char c : text) (out += c) += '\0';
    return out;
  };
  const std::pair<const char*, std::string> files[] = {
      {".obj", std::string(kObj)}, {".off", std::string(kOff)}, {".ply", std::string(kPly)}, {".stl", ascii_stl()}};
  for (const auto& [format, text] : files) {
    expect_tetrahedron("\xEF\xBB\xBF" + text, format);
    expect_tetrahedron(ending(text, "\r\n"), format);
    expect_tetrahedron(ending(text, "\r"), format);
    expect_tetrahedron(wide(text), format);
    expect_tetrahedron(wide(ending(text, "\r\n")), format);
  }
}

TEST(SurfaceFile, OnlyCoordinatesAndCornersOfAPlyMatter) {
  for (const char* type : {"char", "int8", "short", "ushort", "int", "uint", "uint32"})
    expect_tetrahedron(replaced(kPly, "list uchar int", std::string("list ") + type + " short"), ".ply");
  expect_tetrahedron(replaced(replaced(kPly, "0 0 0 1", "0 0 0 nan"), "uchar red", "float nx"), ".ply");
  expect_tetrahedron(
      "ply\nformat ascii 1.0\nelement camera 1\nproperty float a\nproperty list uchar float b\nelement face 4\n"
      "property list uint uint vertex_index\nproperty list uchar float texcoord\nelement vertex 4\nproperty float z\n"
      "property float y\nproperty double x\nend_header\n9 2 1 1\n3 0 2 1 0\n3 0 1 3 1 5\n3 1 2 3 0\n3 0 3 2 0\n"
      "0 0 0\n0 0 1\n0 1.25 0\n1 0 0\n",
      ".ply");
  expect_tetrahedron(
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\n"
      "property list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1.25 0\n0 0 1\n15 0 2 1 -1 0 1 3 -1 1 2 3 -1 0 3 2\n",
      ".ply");
}

TEST(SurfaceFile, SizeOfAnStlDecides) {
  expect_tetrahedron(replaced(binary_stl(), std::string(5, ' '), "solid"), ".stl");
  expect_tetrahedron(binary_stl() + "end", ".stl");
  for (const char count : {'\0', '\3'}) {
    std::string odd = binary_stl();
    odd[80] = count;
    expect_tetrahedron(odd, ".stl");
    EXPECT_EQ(parse_surface(odd, ".stl")->notes.all().size(), 1U);
  }
  std::string many = binary_stl();
  many[80] = 5;
  expect_broken(parse_surface(many, ".stl"), "R-SRF-5", "announces 5 facets and holds 4");
  std::string capitals = ascii_stl();
  for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  expect_tetrahedron(capitals, ".stl");
}

TEST(SurfaceFile, FacesWithoutAreaAreNamedOrDropped) {
  const std::string text = std::string(kObj) + "f 1 1 2\nf 3 4 4\n";
  const auto refused = parse_surface(text, ".obj");
  ASSERT_FALSE(refused);
  EXPECT_EQ(to_string(refused.error()).find(":15: face 4: vertices 1 1 2, the first of 2: R-SRF-10: "), 0U)
      << to_string(refused.error());
  const auto dropped = parse_surface(text, ".obj", {.drop_degenerate = true});
  ASSERT_TRUE(dropped) << to_string(dropped.error());
  EXPECT_EQ(dropped->dropped_faces, 2U);
  EXPECT_EQ(dropped->mesh.triangles.size(), 4U);
}

TEST(SurfaceFile, CoordinatesKeepDoublePrecision) {
  for (const auto& [format, text] :
       {std::pair{".obj", std::string(kObj)}, {".off", std::string(kOff)}, {".ply", std::string(kPly)}}) {
    const auto file = parse_surface(replaced(text, "0 1.25 0", "0 1000.00123 0"), format);
    ASSERT_TRUE(file) << to_string(file.error());
    EXPECT_EQ(file->mesh.vertices[2].y, 1000.00123) << format;
  }
}

}  // namespace
}  // namespace tactus::sim
