// SPDX-License-Identifier: Apache-2.0
/// What a participant's device needs to know of objects is declared through the C interface as by the C++ library.
#include <tactus/scene/scene_builder.h>
#include <tactus/scene/scene_syntax.h>

#include "tests/bindings/fixture.h"

namespace tactus::c_test {
namespace {

constexpr DrivenPhysics kDriven{
    .mass = 0.2, .inertia = {1e-4, 2e-4, 3e-4}, .stiffness = 400, .hold = 200, .friction = 0.3, .damping = 1};

tactus_driven_physics driven() {
  auto out = filled<tactus_driven_physics>();
  out.mass = kDriven.mass;
  out.inertia[0] = kDriven.inertia.x;
  out.inertia[1] = kDriven.inertia.y;
  out.inertia[2] = kDriven.inertia.z;
  out.stiffness = kDriven.stiffness;
  out.hold = kDriven.hold;
  out.friction = kDriven.friction;
  out.damping = kDriven.damping;
  return out;
}

/// A tetrahedron of four, which meet in a vertex inside.
struct Pyramid {
  std::vector<double> vertices{0, 0, 0, 0.05, 0, 0, 0, 0.05, 0, 0, 0, 0.05};
  std::vector<std::uint32_t> triangles{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  std::vector<double> inner{0.0125, 0.0125, 0.0125};
  std::vector<std::uint32_t> tets{0, 1, 2, 4, 0, 3, 1, 4, 0, 2, 3, 4, 1, 3, 2, 4};
  std::vector<double> materials{1e4, 0.4, 1000, 2e4, 0.45, 900};
  std::vector<std::uint8_t> material{0, 1, 0, 1};
  std::vector<std::uint32_t> fixed{0, 2};

  tactus_elastic_physics physics() const {
    auto out = filled<tactus_elastic_physics>();
    out.material_count = 2;
    out.materials = materials.data();
    out.inner = inner.data();
    out.inner_count = 1;
    out.tets = tets.data();
    out.tet_count = 4;
    out.material = material.data();
    out.fixed = fixed.data();
    out.fixed_count = fixed.size();
    out.mass_damping = 1;
    out.stiffness_damping = 0.002;
    out.gravity[2] = -9.81;
    out.coupling = 300;
    out.friction = 0.5;
    out.method = TACTUS_METHOD_VELOCITY_VERLET;
    out.sub_steps = 40;
    return out;
  }
  ElasticPhysics of_library() const {
    ElasticPhysics out{.body = {.inner = {},
                                .tets = {},
                                .materials = {{1e4, 0.4, 1000}, {2e4, 0.45, 900}},
                                .material = material,
                                .fixed = fixed,
                                .mass_damping = 1,
                                .stiffness_damping = 0.002,
                                .gravity = {0, 0, -9.81},
                                .coupling = 300,
                                .friction = 0.5,
                                .method = ElasticBody::Method::velocity_verlet,
                                .sub_steps = 40},
                       .inner = {{inner[0], inner[1], inner[2]}}};
    for (std::size_t i = 0; i < tets.size(); i += 4) out.body.tets.push_back({tets[i], tets[i + 1], tets[i + 2], tets[i + 3]});
    return out;
  }
  TriMesh surface() const {
    TriMesh out;
    for (std::size_t i = 0; i < vertices.size(); i += 3) out.vertices.push_back({vertices[i], vertices[i + 1], vertices[i + 2]});
    for (std::size_t i = 0; i < triangles.size(); i += 3)
      out.triangles.push_back({triangles[i], triangles[i + 1], triangles[i + 2]});
    return out;
  }
  tactus_status add_to(tactus_scene_builder* builder, const tactus_elastic_physics* physics,
                       tactus_error* error = nullptr) const {
    auto coding = filled<tactus_deformable_options>();
    coding.frame_period = 5;
    coding.elastic = physics;
    return tactus_scene_builder_deformable(builder, "pyramid", vertices.data(), 4, triangles.data(), 4, &coding, error);
  }
};

Builder made() {
  tactus_scene_builder* raw = nullptr;
  EXPECT_EQ(tactus_scene_builder_create(nullptr, &raw, nullptr), TACTUS_OK);
  return Builder(raw);
}

/// What building answers: the scene's bytes, or the rule that it breaks.
std::vector<std::uint8_t> built(const Builder& builder) {
  tactus_scene* raw = nullptr;
  tactus_error error{};
  EXPECT_EQ(tactus_scene_builder_build(builder.get(), &raw, &error), TACTUS_OK) << error.object;
  const Scene scene(raw);
  std::size_t size = 0;
  EXPECT_EQ(tactus_scene_write(scene.get(), nullptr, 0, &size, nullptr), TACTUS_BUFFER_TOO_SMALL);
  std::vector<std::uint8_t> out(size);
  EXPECT_EQ(tactus_scene_write(scene.get(), out.data(), size, &size, nullptr), TACTUS_OK);
  return out;
}
std::string refusal(const Builder& builder) {
  tactus_scene* raw = nullptr;
  tactus_error error{};
  EXPECT_NE(tactus_scene_builder_build(builder.get(), &raw, &error), TACTUS_OK);
  EXPECT_EQ(raw, nullptr);
  return error.rule == nullptr ? "none" : error.rule;
}

TEST(CDevicePhysics, IsWhatTheLibraryDeclares) {
  const Builder builder = made();
  const tactus_driven_physics push = driven();
  auto box = filled<tactus_rigid_options>();
  box.driven = &push;
  EXPECT_EQ(tactus_scene_builder_rigid(builder.get(), "plain", nullptr, nullptr), TACTUS_OK);
  EXPECT_EQ(tactus_scene_builder_rigid(builder.get(), "box", &box, nullptr), TACTUS_OK);
  const Pyramid pyramid;
  const tactus_elastic_physics body = pyramid.physics();
  EXPECT_EQ(pyramid.add_to(builder.get(), &body), TACTUS_OK);

  SceneBuilder library;
  library.rigid("plain").rigid("box", {}, {.driven = kDriven});
  library.deformable("pyramid", pyramid.surface(), {.frame_period = 5, .elastic = pyramid.of_library()});
  EXPECT_EQ(built(builder), write_scene(*library.build().value()).value());
}

TEST(CDevicePhysics, OneMaterialAndNothingInsideNeedNoArrays) {
  const Builder builder = made();
  Pyramid pyramid;
  pyramid.tets = {0, 1, 2, 3};
  tactus_elastic_physics body = pyramid.physics();
  body.material_count = 1;
  body.tet_count = 1;
  body.material = nullptr;
  body.inner = nullptr;
  body.inner_count = 0;
  EXPECT_EQ(pyramid.add_to(builder.get(), &body), TACTUS_OK);
  const auto scene = parse_scene(built(builder)).value().scene;
  EXPECT_EQ(scene->deformables[0].body->material, std::vector<std::uint8_t>{0});
  EXPECT_TRUE(scene->deformables[0].body->inner.empty());
}

TEST(CDevicePhysics, RefusesAtOnceWhatItCannotRead) {
  const Builder builder = made();
  const Pyramid pyramid;
  const auto refuses = [&](const char* rule, const auto& change) {
    tactus_elastic_physics body = pyramid.physics();
    change(body);
    tactus_error error{};
    EXPECT_NE(pyramid.add_to(builder.get(), &body, &error), TACTUS_OK);
    EXPECT_STREQ(error.rule, rule);
  };
  refuses("R-API-12", [](tactus_elastic_physics& b) { b.tets = nullptr; });
  refuses("R-API-12", [](tactus_elastic_physics& b) { b.materials = nullptr; });
  refuses("R-API-12", [](tactus_elastic_physics& b) { b.inner = nullptr; });
  refuses("R-API-12", [](tactus_elastic_physics& b) { b.fixed = nullptr; });
  refuses("R-ELA-2", [](tactus_elastic_physics& b) { b.material_count = 256; });
  refuses("R-ELA-1", [](tactus_elastic_physics& b) { b.method = 0; });
  refuses("R-ELA-1", [](tactus_elastic_physics& b) { b.method = 4; });
  refuses("R-ELA-5", [](tactus_elastic_physics& b) { b.sub_steps = 256; });
  for (std::size_t tactus_elastic_physics::*count :
       {&tactus_elastic_physics::tet_count, &tactus_elastic_physics::inner_count, &tactus_elastic_physics::fixed_count})
    refuses("R-ELA-3", [count](tactus_elastic_physics& b) { b.*count = ~std::size_t{0} / 2; });
}

TEST(CDevicePhysics, BuildingRefusesWhatIsWrong) {
  const auto refusal_of = [](const auto& change) {
    const Builder builder = made();
    Pyramid pyramid;
    tactus_elastic_physics body = pyramid.physics();
    change(pyramid, body);
    EXPECT_EQ(pyramid.add_to(builder.get(), &body), TACTUS_OK);
    return refusal(builder);
  };
  EXPECT_EQ(refusal_of([](Pyramid&, tactus_elastic_physics& b) { b.coupling = 0; }), "R-ELA-2");
  EXPECT_EQ(refusal_of([](Pyramid& p, tactus_elastic_physics&) { p.materials[0] = -1; }), "R-ELA-2");
  EXPECT_EQ(refusal_of([](Pyramid&, tactus_elastic_physics& b) { b.sub_steps = 0; }), "R-ELA-5");
  EXPECT_EQ(refusal_of([](Pyramid& p, tactus_elastic_physics&) { std::swap(p.tets[0], p.tets[1]); }), "R-ELA-4");
  EXPECT_EQ(refusal_of([](Pyramid& p, tactus_elastic_physics&) { p.inner[0] = NAN; }), "R-API-1");

  const Builder builder = made();
  tactus_driven_physics push = driven();
  push.mass = 0;
  auto box = filled<tactus_rigid_options>();
  box.driven = &push;
  EXPECT_EQ(tactus_scene_builder_rigid(builder.get(), "box", &box, nullptr), TACTUS_OK);
  EXPECT_EQ(refusal(builder), "R-API-4");
}

}  // namespace
}  // namespace tactus::c_test
