// SPDX-License-Identifier: Apache-2.0
// [[deformable]] and circles in scenes: sim/scene/scene.h.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <tactus/sim/scene/scene.h>
#include <tactus/sim/tets/tet_files.h>

namespace tactus::sim {
namespace {

const std::string kHead =
    "name = \"test\"\n"
    "duration = 1.0\n"
    "gravity = [0, 0, 0]\n";  // lines 1 to 3
const std::string kSlab =
    "[[deformable]]\n"
    "name = \"slab\"\n"
    "cells = [4, 3, 2]\n"
    "cell = 0.01\n"
    "position = [1, 2, 3]\n"
    "young = 1e4\n"
    "poisson = 0.45\n"
    "density = 1000\n";  // lines 4 to 11

Scene parsed(const std::string& text) {
  const auto scene = parse_scene(text, "t.toml");
  EXPECT_TRUE(scene) << to_string(scene.error());
  return scene.value_or(Scene{});
}

TEST(DeformableScene, DefaultsAreWhatTheHeaderSays) {
  const Scene scene = parsed(kHead + "[touch]\nstiffness = 20\nfriction = 0.3\nlift_stiffness = 10\n" + kSlab);
  ASSERT_EQ(scene.deformables.size(), 1u);
  const SceneDeformable& slab = scene.deformables[0];
  EXPECT_EQ(slab.name, "slab");
  EXPECT_EQ(slab.mesh.vertices.size(), 60u);
  EXPECT_EQ(slab.mesh.tets.size(), 144u);
  EXPECT_EQ(slab.mesh.vertices.front(), (Vec3{1, 2, 3}));
  EXPECT_LT(norm(slab.mesh.vertices.back() - Vec3{1.04, 2.03, 3.02}), 1e-12);
  ASSERT_EQ(slab.materials.size(), 1u);
  EXPECT_EQ(slab.materials[0].young, 1e4);
  EXPECT_TRUE(slab.fixed.empty());
  EXPECT_TRUE(slab.corotated);
  EXPECT_EQ(slab.mass_damping, 0);
  EXPECT_EQ(slab.stiffness_damping, 0);
  EXPECT_EQ(slab.stiffness, 20) << "that of [touch]";
  EXPECT_EQ(slab.friction, 0.3);
  EXPECT_EQ(slab.method, "auto");
  EXPECT_EQ(slab.solver, "auto");
  EXPECT_EQ(slab.rate, 1u);
}

TEST(DeformableScene, RegionsAndFixedVerticesAreInTheMeshsOwnFrame) {
  const Scene scene = parsed(kHead + kSlab +
                             "[[deformable.fixed]]\nlow = [0, 0, 0]\nhigh = [0, 0.03, 0.02]\n"
                             "[[deformable.fixed]]\nlow = [0, 0, 0]\nhigh = [0.04, 0, 0]\n"
                             "[[deformable.region]]\nyoung = 500\npoint = [0.02, 0, 0]\nnormal = [1, 0, 0]\n"
                             "[[deformable.region]]\ndensity = 7\nlow = [0.03, 0, 0]\nhigh = [0.04, 0.03, 0.01]\n");
  const SceneDeformable& slab = scene.deformables.at(0);
  EXPECT_EQ(slab.fixed.size(), 12u + 4u) << "one side and the rest of an edge, each once";
  ASSERT_EQ(slab.materials.size(), slab.mesh.tets.size());
  EXPECT_EQ(std::count_if(slab.materials.begin(), slab.materials.end(), [](auto& m) { return m.young == 500; }), 72 - 18);
  EXPECT_EQ(std::count_if(slab.materials.begin(), slab.materials.end(), [](auto& m) { return m.density == 7; }), 18);
  EXPECT_EQ(std::count_if(slab.materials.begin(), slab.materials.end(), [](auto& m) { return m.young == 1e4; }), 72 + 18)
      << "a region starts from the object's own material";
}

TEST(DeformableScene, CornersOfASlabAreEight) {
  const Scene scene = parsed(kHead + kSlab + "fixed = \"corners\"\n");
  EXPECT_EQ(scene.deformables.at(0).fixed, (std::vector<std::uint32_t>{0, 4, 15, 19, 40, 44, 55, 59}));
}

TEST(DeformableScene, TheThesissMembraneHasItsCounts) {
  for (const char* name : {"membrane", "membrane-light"}) {
    const auto scene = load_scene(find_scene(name).value());
    ASSERT_TRUE(scene) << to_string(scene.error());
    const SceneDeformable& membrane = scene->deformables.at(0);
    EXPECT_EQ(membrane.mesh.vertices.size(), 714u);
    EXPECT_EQ(membrane.mesh.tets.size(), 1920u);
    EXPECT_EQ(surface(membrane.mesh).mesh.triangles.size(), 1424u);
    EXPECT_EQ(membrane.fixed.size(), 8u);
    EXPECT_EQ(std::count_if(membrane.materials.begin(), membrane.materials.end(), [](auto& m) { return m.young == 2500; }), 960);
  }
}

TEST(DeformableScene, MeshFilesLieBesideTheScene) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "tactus_deformable_scene";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "block.msh") << [] {
    std::ostringstream out;
    write_msh(out, make_slab(2, 1, 1, 0.5));
    return out.str();
  }();
  std::ofstream(folder / "flat.msh") << [] {
    std::ostringstream out;
    TetMesh mesh = make_slab(1, 1, 1, 0.5);
    for (Vec3& v : mesh.vertices) v.z = 0;
    write_msh(out, mesh);
    return out.str();
  }();
  const auto with = [&](const std::string& file) {
    std::string text = kHead + kSlab;
    const auto at = text.find("cells");
    text.replace(at, text.find("position") - at, "mesh = \"" + file + "\"\n");
    std::ofstream(folder / "scene.toml") << text;
    return load_scene((folder / "scene.toml").string());
  };
  const auto good = with("block.msh");
  ASSERT_TRUE(good) << to_string(good.error());
  EXPECT_EQ(good->deformables.at(0).mesh.tets.size(), 12u);
  EXPECT_EQ(good->deformables.at(0).mesh.vertices.at(0), (Vec3{1, 2, 3}));
  for (const auto& [file, rule] : {std::pair{"no-such.msh", "R-TET-8"}, {"block.stl", "R-TET-17"}, {"flat.msh", "R-TET-3"}}) {
    const auto scene = with(file);
    ASSERT_FALSE(scene) << file;
    EXPECT_STREQ(scene.error().error.rule, "R-SCN-8");
    EXPECT_EQ(scene.error().detail, "deformable.mesh");
    EXPECT_EQ(scene.error().line, 6u);
    EXPECT_NE(scene.error().remedy.find(rule), std::string::npos) << scene.error().remedy;
    EXPECT_NE(scene.error().remedy.find(file), std::string::npos) << scene.error().remedy;
  }
  std::filesystem::remove_all(folder);
}

struct Broken {
  const char* why;
  std::string text;
  const char* rule;
  std::uint32_t line;
  const char* key;
};

TEST(DeformableScene, EveryRuleNamesItsLocation) {
  const std::string body = kHead + kSlab;
  const auto with = [&](const std::string& key, const std::string& line) {
    const auto at = body.find(key);
    return body.substr(0, at) + line + body.substr(body.find('\n', at));
  };
  const std::vector<Broken> cases{
      {"unknown key", body + "colour = 1\n", "R-SCN-3", 12, "deformable.colour"},
      {"nothing it is made of", with("cells", ""), "R-SCN-4", 4, "deformable.cells"},
      {"slab and file", body + "mesh = \"a.msh\"\n", "R-SCN-4", 4, "deformable.cells"},
      {"no density", with("density", ""), "R-SCN-4", 4, "deformable.density"},
      {"no cell size", with("cell =", ""), "R-SCN-4", 4, "deformable.cell"},
      {"half a cell", with("cells", "cells = [1, 2.5, 1]"), "R-SCN-5", 6, "deformable.cells"},
      {"flat slab", with("cells", "cells = [1, 0, 1]"), "R-SCN-6", 6, "deformable.cells"},
      {"huge slab", with("cells", "cells = [1000, 1000, 1]"), "R-SCN-6", 6, "deformable.cells"},
      {"incompressible", with("poisson", "poisson = 0.5"), "R-SCN-6", 10, "deformable.poisson"},
      {"massless", with("density", "density = 0"), "R-SCN-6", 11, "deformable.density"},
      {"never deformed", body + "rate = 0\n", "R-SCN-6", 12, "deformable.rate"},
      {"half a tick", body + "rate = 1.5\n", "R-SCN-5", 12, "deformable.rate"},
      {"negative damping", body + "mass_damping = -1\n", "R-SCN-6", 12, "deformable.mass_damping"},
      {"unknown method", body + "method = \"euler\"\n", "R-SCN-7", 12, "deformable.method"},
      {"unknown solver", body + "solver = \"lu\"\n", "R-SCN-7", 12, "deformable.solver"},
      {"unknown word", body + "fixed = \"edges\"\n", "R-SCN-7", 12, "deformable.fixed"},
      {"empty box", body + "[[deformable.fixed]]\nlow = [9, 9, 9]\nhigh = [10, 10, 10]\n", "R-SCN-6", 12, "deformable.fixed"},
      {"empty region", body + "[[deformable.region]]\npoint = [9, 0, 0]\nnormal = [1, 0, 0]\n", "R-SCN-6", 12,
       "deformable.region"},
      {"region without a point", body + "[[deformable.region]]\nyoung = 1\n", "R-SCN-4", 12, "deformable.region.point"},
      {"two of one name", body + kSlab, "R-SCN-7", 12, "deformable.name"},
      {"centre without turns",
       body + "[touch]\nstiffness = 1\nfriction = 0\nlift_stiffness = 1\n[[user]]\nname = \"u\"\nobject = \"slab\"\n"
              "start = [0, 0, 0]\n[[user.path]]\nname = \"p\"\nto = [0, 0, 0]\nduration = 1\ncentre = [0, 0, 0]\n",
       "R-SCN-4", 24, "user.path.turns"},
  };
  for (const Broken& c : cases) {
    const auto scene = parse_scene(c.text, "t.toml");
    ASSERT_FALSE(scene) << c.why;
    EXPECT_FALSE(scene.error().remedy.empty()) << c.why;
    EXPECT_STREQ(scene.error().error.rule, c.rule) << c.why;
    EXPECT_EQ(scene.error().line, c.line) << c.why;
    EXPECT_EQ(scene.error().detail, c.key) << c.why;
  }
}

}  // namespace
}  // namespace tactus::sim
