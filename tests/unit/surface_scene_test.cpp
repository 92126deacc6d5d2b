// SPDX-License-Identifier: Apache-2.0
// `surface = FILE` of [[object]]: sim/scene/object_surface.h.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include <tactus/sim/simulation.h>
#include "tests/unit/tet_fixture.h"

namespace tactus::sim {
namespace {

constexpr const char* kCorner =
    "v 1 1 1\nv 1.04 1 1\nv 1 1.04 1\nv 1 1 1.04\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";  // a tetrahedron, closed

std::string scene_text(const std::string& surface) {
  return "name = \"t\"\nduration = 1.0\ngravity = [0, 0, 0]\n[[object]]\nname = \"solid\"\n" + surface +
         "\nmass = 0.1\nfriction = 0.5\nposition = [-1, -1, 2]\nrotation = [0, 0, 0, 1]\n";  // surface: line 6
}

TEST(SurfaceScene, TheObjectsFrameIsAtItsCentreOfMass) {
  const TempFolder folder;
  folder.write("corner.obj", kCorner);
  const auto scene = load_scene(folder.write("t.toml", scene_text("surface = \"corner.obj\"")));
  ASSERT_TRUE(scene) << to_string(scene.error());
  const SceneObject& object = scene->objects.at(0);
  ASSERT_EQ(object.surface.triangles.size(), 4u);
  Vec3 sum;
  for (const Vec3& v : object.surface.vertices) sum = sum + v;
  EXPECT_LT(norm(sum), 1e-6) << "single precision of the file's coordinates";
  EXPECT_LT(norm(object.size - Vec3{0.04, 0.04, 0.04}), 1e-6);
  EXPECT_LT(norm(object.pose.position - Vec3{-2.01, -2.01, 3.01}), 1e-6) << "the centre, half a turn about z round the origin";
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(to_world(object.pose, object.surface.vertices[i]).z, i == 3 ? 3.04 : 3.0, 1e-6);
}

TEST(SurfaceScene, BadFilesNameFileLocationRuleAndRemedy) {
  const TempFolder folder;
  folder.write("corner.obj", kCorner);
  folder.write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\n");
  folder.write("inward.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n");
  folder.write("fan.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 -1\nf 1 2 3\nf 1 2 4\nf 1 2 5\n");
  folder.write("giant.obj", "v 0 0 0\nv 900 0 0\nv 0 900 0\nv 0 0 900\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  folder.write("words.obj", "hello\n");
  struct Broken {
    std::string surface;
    const char* rule;
    const char* key;
    const char* says;
  };
  const std::vector<Broken> cases{{"surface = \"none.obj\"", "R-SCN-8", "object.surface", "R-SRF-1"},
                                  {"surface = \"words.obj\"", "R-SCN-8", "object.surface", "R-SRF-"},
                                  {"surface = \"open.obj\"", "R-SCN-8", "object.surface", "triangle 0: R-TGN-2"},
                                  {"surface = \"inward.obj\"", "R-SCN-8", "object.surface", "R-TGN-4"},
                                  {"surface = \"fan.obj\"", "R-SCN-8", "object.surface", "R-SRF-11"},
                                  {"surface = \"giant.obj\"", "R-SCN-6", "object.surface", "metres"},
                                  {"size = [1, 1, 1]\nsurface = \"corner.obj\"", "R-SCN-4", "object.size", "either"},
                                  {"", "R-SCN-4", "object.size", ""}};
  for (const Broken& c : cases) {
    const auto scene = load_scene(folder.write("t.toml", scene_text(c.surface)));
    ASSERT_FALSE(scene) << c.surface;
    EXPECT_STREQ(scene.error().error.rule, c.rule) << to_string(scene.error());
    EXPECT_EQ(scene.error().detail, c.key) << c.surface;
    EXPECT_EQ(scene.error().line, c.surface.empty() ? 4u : 6u) << c.surface;
    EXPECT_NE(scene.error().remedy.find(c.says), std::string::npos) << scene.error().remedy;
  }
}

TEST(SurfaceScene, TwoUsersTouchASolidAndADeformable) {
  const Scene scene = load_scene(find_scene("bracket-and-pad").value()).value();
  auto simulation = Simulation::create(scene);
  ASSERT_TRUE(simulation);
  std::array<int, 2> bracket{}, pad{};
  int at_once = 0;
  double farthest = 0;
  float deepest = 0;
  for (std::int64_t i = 0; i < simulation->ticks(); ++i) {
    ASSERT_TRUE(simulation->step()) << i;
    const TraceFrame& frame = simulation->frame();
    const Pose& pose = frame.objects.at(0).pose;
    farthest = std::max(farthest, pose.position.x);
    for (const float value : frame.meshes.at(0).displacements) deepest = std::min(deepest, value);
    for (std::size_t u = 0; u < 2; ++u) {
      const UserSample& user = frame.users[u];
      pad[u] += user.surface_contact.has_value();
      if (user.contact.kind == ContactKind::none) continue;
      ++bracket[u];
      const Vec3 normal = rotate(pose.rotation, user.contact.normal);
      ASSERT_LT(norm(dot(user.server_force, normal) * normal - contact_force(user.contact, pose)), 1e-9) << i;
    }
    at_once += frame.users[0].surface_contact && frame.users[1].contact.kind == ContactKind::surface;
  }
  for (std::size_t u = 0; u < 2; ++u) {
    EXPECT_GT(bracket[u], 500) << u;
    EXPECT_GT(pad[u], 500) << u;
  }
  EXPECT_GT(at_once, 500);
  EXPECT_GT(farthest, 0.06) << "pushed away";
  EXPECT_LT(simulation->frame().objects[0].pose.position.x, 0.05) << "and back, from its inner corner";
  EXPECT_LT(deepest, -0.002F);
}

}  // namespace
}  // namespace tactus::sim
