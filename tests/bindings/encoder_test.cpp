// SPDX-License-Identifier: Apache-2.0
/// The encoder's side of the C interface does what the C++ library does.
#include <tactus/deformable/motion_clusters.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/scene/scene_syntax.h>
#include <tactus/sender.h>

#include "tests/bindings/fixture.h"
#include "tests/unit/deformable_fixture.h"

namespace tactus::c_test {
namespace {

/// A sheet whose halves turn about the line between them, as C takes it.
struct Hinge {
  static constexpr std::size_t kShapes = 10;

  TriMesh mesh = testing::sheet(12, 12);
  std::vector<double> vertices;
  std::vector<std::uint32_t> triangles;
  std::vector<float> shapes;

  Hinge() {
    for (const Vec3& v : mesh.vertices) vertices.insert(vertices.end(), {v.x, v.y, v.z});
    for (const Triangle& t : mesh.triangles) triangles.insert(triangles.end(), t.begin(), t.end());
    for (std::size_t i = 0; i < kShapes; ++i) {
      const std::vector<float> one = shape(0.1 * static_cast<double>(i));
      shapes.insert(shapes.end(), one.begin(), one.end());
    }
  }
  std::vector<float> shape(double slope) const {
    const double middle = 0.5 * (mesh.vertices.front().x + mesh.vertices.back().x);
    std::vector<float> out;
    for (const Vec3& v : mesh.vertices) out.insert(out.end(), {0, 0, static_cast<float>(slope * std::abs(v.x - middle))});
    return out;
  }
  std::size_t count() const { return mesh.vertices.size(); }
  tactus_status find(std::uint32_t most, tactus_deformable_options& out, std::vector<std::uint8_t>& clusters,
                     tactus_error* error = nullptr) const {
    clusters.resize(count());
    out.clusters = clusters.data();
    return tactus_find_clusters(vertices.data(), count(), triangles.data(), triangles.size() / 3, shapes.data(), kShapes, most,
                                clusters.data(), &out.cluster_count, &out.blend, error);
  }
  Scene scene(const tactus_deformable_options& coding, const tactus_deformable_bounds* bounds = nullptr) const {
    tactus_scene_builder* raw = nullptr;
    EXPECT_EQ(tactus_scene_builder_create(nullptr, &raw, nullptr), TACTUS_OK);
    const Builder builder(raw);
    EXPECT_EQ(tactus_scene_builder_deformable(raw, "hinge", vertices.data(), count(), triangles.data(), triangles.size() / 3,
                                              &coding, nullptr),
              TACTUS_OK);
    EXPECT_EQ(tactus_scene_builder_declare_bounds(raw, nullptr, bounds, nullptr, nullptr), TACTUS_OK);
    tactus_scene* out = nullptr;
    EXPECT_EQ(tactus_scene_builder_build(raw, &out, nullptr), TACTUS_OK);
    return Scene(out);
  }
};

std::vector<std::uint8_t> written(const Scene& scene) {
  std::size_t size = 0;
  EXPECT_EQ(tactus_scene_write(scene.get(), nullptr, 0, &size, nullptr), TACTUS_BUFFER_TOO_SMALL);
  std::vector<std::uint8_t> out(size);
  EXPECT_EQ(tactus_scene_write(scene.get(), out.data(), size, &size, nullptr), TACTUS_OK);
  return out;
}

/// What is not named is not looked at, and a program that knows only the first version is not asked.
TEST(CEncoder, WhatMovedMayBeNamed) {
  const Scene scene = make_scene();
  tactus_sender* raw = nullptr;
  ASSERT_EQ(tactus_sender_create(scene.get(), nullptr, &raw, nullptr), TACTUS_OK);
  const Sender sender(raw);
  std::array<tactus_rigid_sample, 2> objects{};
  for (tactus_rigid_sample& object : objects) object.pose.rotation[0] = 1;
  objects[1].pose.position[2] = 0.05;
  auto truth = filled<tactus_truth>();
  truth.objects = objects.data();
  truth.object_count = objects.size();
  const auto packets = [&](std::int64_t tick) { return encode(sender, tick, &truth).size(); };
  const std::uint32_t cube = 1;
  EXPECT_EQ(packets(0), 0u);
  objects[1].pose.position[0] = 0.1;
  truth.moved = &cube;
  EXPECT_EQ(packets(1), 0u) << "it is not named";
  truth.moved_count = 1;
  EXPECT_EQ(packets(2), 1u);
  objects[1].pose.position[0] = 0.2;
  truth.size = offsetof(tactus_truth, moved);
  truth.moved_count = 0;
  EXPECT_EQ(packets(3), 1u) << "as all are compared";
  truth = filled<tactus_truth>();
  truth.moved_count = 1;
  auto encoded = sized<tactus_encoded>();
  EXPECT_REFUSED("R-API-12", tactus_sender_encode, sender.get(), 4, &truth, &encoded);
}

TEST(CEncoder, ClustersAreThoseOfTheLibrary) {
  const Hinge hinge;
  auto coding = filled<tactus_deformable_options>();
  std::vector<std::uint8_t> clusters;
  ASSERT_EQ(hinge.find(4, coding, clusters), TACTUS_OK);
  std::vector<std::vector<float>> shapes;
  for (auto at = hinge.shapes.begin(); at != hinge.shapes.end(); at += static_cast<std::ptrdiff_t>(3 * hinge.count()))
    shapes.emplace_back(at, at + static_cast<std::ptrdiff_t>(3 * hinge.count()));
  const ClusterBasis expected = motion_clusters(hinge.mesh, shapes, 4).value();
  EXPECT_EQ(clusters, expected.clusters);
  EXPECT_EQ(coding.cluster_count, expected.count);
  EXPECT_EQ(coding.blend, expected.blend);
  EXPECT_GT(coding.cluster_count, 1u);

  const Scene scene = hinge.scene(coding);
  EXPECT_EQ(parse_scene(written(scene)).value().scene->deformables.at(0).cluster_basis, expected);
  auto info = sized<tactus_deformable_info>();
  ASSERT_EQ(tactus_scene_get_deformable(scene.get(), 0, &info, nullptr), TACTUS_OK);
  EXPECT_EQ(info.clusters, expected.count);
  EXPECT_EQ(info.blend, expected.blend);
  EXPECT_EQ(info.modes, 12u * expected.count);
  std::vector<std::uint8_t> returned(hinge.count());
  auto arrays = sized<tactus_mesh_arrays>();
  arrays.clusters = returned.data();
  arrays.vertices = static_cast<std::uint32_t>(returned.size() - 1);
  EXPECT_REFUSED("R-API-13", tactus_scene_get_mesh, scene.get(), 0, &arrays);
  ++arrays.vertices;
  ASSERT_EQ(tactus_scene_get_mesh(scene.get(), 0, &arrays, nullptr), TACTUS_OK);
  EXPECT_EQ(returned, clusters);
}

TEST(CEncoder, ClustersMakeAStreamSmallerWithinItsBound) {
  const Hinge hinge;
  auto coding = filled<tactus_deformable_options>();
  std::vector<std::uint8_t> clusters;
  std::size_t bytes[2] = {};
  for (const bool with_clusters : {false, true}) {
    if (with_clusters) {
      ASSERT_EQ(hinge.find(4, coding, clusters), TACTUS_OK);
    }
    const Scene scene = hinge.scene(coding);
    const Sender sender = make_sender(scene);
    const Receiver receiver = make_receiver(scene);
    std::vector<float> shown(3 * hinge.count());
    for (std::int64_t tick = 0; tick < 200; ++tick) {
      const std::vector<float> truth = hinge.shape(std::sin(0.02 * static_cast<double>(tick)));
      const tactus_shape shape{truth.data(), hinge.count(), 0, 0, 0, 0};
      auto given = sized<tactus_truth>();
      given.shapes = &shape;
      given.shape_count = 1;
      for (const Packet& packet : encode(sender, tick, &given)) {
        bytes[with_clusters] += packet.bytes.size();
        ASSERT_EQ(push(receiver, packet, tick), TACTUS_OK);
      }
      ASSERT_EQ(tactus_receiver_displacements(receiver.get(), 0, tick, shown.data(), shown.size(), nullptr), TACTUS_OK);
      for (std::size_t i = 0; i < shown.size(); ++i) ASSERT_NEAR(shown[i], truth[i], 3.1e-4) << tick;
    }
  }
  EXPECT_LT(bytes[1], bytes[0] / 2);
}

TEST(CEncoder, FindingClustersRefuses) {
  const Hinge hinge;
  auto coding = filled<tactus_deformable_options>();
  std::vector<std::uint8_t> clusters;
  tactus_error error{};
  for (const std::uint32_t most : {0u, 65u}) {
    EXPECT_EQ(hinge.find(most, coding, clusters, &error), TACTUS_INVALID_ARGUMENT);
    EXPECT_STREQ(error.rule, "R-API-4") << most;
  }
  const auto find = [&](const double* vertices, const float* shapes, std::size_t count, std::uint8_t* out) {
    EXPECT_NE(tactus_find_clusters(vertices, hinge.count(), hinge.triangles.data(), hinge.triangles.size() / 3, shapes, count, 4,
                                   out, &coding.cluster_count, &coding.blend, &error),
              TACTUS_OK);
    return error.rule;
  };
  EXPECT_STREQ(find(nullptr, hinge.shapes.data(), 1, clusters.data()), "R-API-12");
  EXPECT_STREQ(find(hinge.vertices.data(), nullptr, 1, clusters.data()), "R-API-12");
  EXPECT_STREQ(find(hinge.vertices.data(), hinge.shapes.data(), 1, nullptr), "R-API-12");
  EXPECT_STREQ(find(hinge.vertices.data(), hinge.shapes.data(), 0, clusters.data()), "R-API-5");
  EXPECT_STREQ(find(hinge.vertices.data(), hinge.shapes.data(), SIZE_MAX, clusters.data()), "R-API-5");
  Hinge broken;
  broken.shapes[5] = NAN;
  EXPECT_EQ(broken.find(4, coding, clusters, &error), TACTUS_INVALID_ARGUMENT);
  EXPECT_STREQ(error.rule, "R-API-1");
  broken.triangles[0] = 1u << 30;
  EXPECT_EQ(broken.find(4, coding, clusters, &error), TACTUS_INVALID);
  EXPECT_STREQ(error.rule, "R-SRF-9");
}

TEST(CEncoder, AClusterBeyondTheirCountIsRefused) {
  const Hinge hinge;
  auto coding = filled<tactus_deformable_options>();
  std::vector<std::uint8_t> clusters(hinge.count(), 3);
  coding.clusters = clusters.data();
  coding.cluster_count = 2;
  tactus_scene_builder* raw = nullptr;
  ASSERT_EQ(tactus_scene_builder_create(nullptr, &raw, nullptr), TACTUS_OK);
  const Builder builder(raw);
  ASSERT_EQ(tactus_scene_builder_deformable(raw, "hinge", hinge.vertices.data(), hinge.count(), hinge.triangles.data(),
                                            hinge.triangles.size() / 3, &coding, nullptr),
            TACTUS_OK);
  tactus_scene* scene = nullptr;
  tactus_error error{};
  EXPECT_EQ(tactus_scene_builder_build(raw, &scene, &error), TACTUS_INVALID);
  EXPECT_STREQ(error.rule, "R-DEF-7");
  EXPECT_STREQ(error.object, "hinge");
}

/// Users of the C interface need not ask for it.
TEST(CEncoder, TheLibraryHasComponentThesis) {
  auto options = filled<tactus_scene_options>();
  options.rigid_profile = TACTUS_PROFILE_THESIS;
  tactus_scene_builder* raw = nullptr;
  ASSERT_EQ(tactus_scene_builder_create(&options, &raw, nullptr), TACTUS_OK);
  const Builder builder(raw);
  ASSERT_EQ(tactus_scene_builder_rigid(raw, "cube", nullptr, nullptr), TACTUS_OK);
  auto coding = filled<tactus_deformable_options>();
  coding.profile = TACTUS_PROFILE_THESIS;
  const double corners[] = {0, 0, 0, 0.1, 0, 0, 0, 0.1, 0};
  const std::uint32_t triangles[] = {0, 1, 2};
  ASSERT_EQ(tactus_scene_builder_deformable(raw, "sheet", corners, 3, triangles, 1, &coding, nullptr), TACTUS_OK);
  tactus_scene* made = nullptr;
  ASSERT_EQ(tactus_scene_builder_build(raw, &made, nullptr), TACTUS_OK);
  const std::vector<std::uint8_t> bytes = written(Scene(made));
  EXPECT_STREQ(parse_scene(bytes).error().rule, "R-DEF-2");
  tactus_scene* parsed = nullptr;
  ASSERT_EQ(tactus_scene_parse(bytes.data(), bytes.size(), nullptr, &parsed, nullptr, nullptr), TACTUS_OK);
  const Scene scene(parsed);
  for (const std::int32_t mode : {TACTUS_INTERPOLATION_LINEAR, TACTUS_INTERPOLATION_HERMITE, TACTUS_INTERPOLATION_BLENDING}) {
    auto receiving = filled<tactus_receiver_options>();
    receiving.interpolation = mode;
    tactus_receiver* receiver = nullptr;
    EXPECT_EQ(tactus_receiver_create(scene.get(), &receiving, &receiver, nullptr), TACTUS_OK) << mode;
    tactus_receiver_destroy(receiver);
  }
}

/// The defaults of both are those of the library, for scenes of all kinds of objects.
TEST(CEncoder, WhatIsNotAskedForIsCodedAsByTheLibrary) {
  const std::vector<std::uint8_t> bytes = written(make_scene(true));
  EXPECT_TRUE(parse_scene(bytes).value().scene->is_smoothed);
  TriMesh sheet;
  sheet.vertices = {{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.1, 0}, {0, 0.1, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  const SharedScene expected = SceneBuilder()
                                   .rigid("table", {}, {.dof = Dof::none})
                                   .rigid("cube", {{0, 0, 0.05}, {}})
                                   .deformable("sheet", sheet)
                                   .declare_bounds({}, {})
                                   .build()
                                   .value();
  EXPECT_EQ(bytes, write_scene(*expected).value());
  const Scene c_scene = make_scene(true);
  const Sender sender = make_sender(c_scene);
  auto cpp_sender = tactus::Sender::create(expected).value();
  Truth truth(true);
  std::size_t packets = 0;
  for (std::int64_t tick = 0; tick < 500; ++tick) {
    const std::vector<Packet> sent = encode(sender, tick, truth.at(tick));
    const tactus_rigid_sample& cube = truth.objects[1];
    const RigidSample samples[] = {{}, {{{cube.pose.position[0], 0, 0.05}, {}}, {cube.velocity[0], 0, 0}, {}}};
    const DeformableTruth shapes[] = {{truth.displacements, {}}};
    const auto wanted = cpp_sender.encode(tick, {.objects = samples, .deformables = shapes}).value();
    ASSERT_EQ(sent.size(), wanted.size()) << tick;
    packets += sent.size();
    for (std::size_t i = 0; i < sent.size(); ++i) ASSERT_TRUE(std::ranges::equal(sent[i].bytes, wanted[i].bytes)) << tick;
  }
  EXPECT_GT(packets, 10u);
}

/// Numbers of each substream count from 1, and are what a receiver reports and a sender takes as acknowledged.
TEST(CEncoder, ANumberGoesWithEachPacketAndComesBack) {
  auto wide = filled<tactus_scene_options>();
  wide.baselines = 64;
  const Scene scene = make_scene(true, &wide);
  auto options = filled<tactus_sender_options>();
  options.baseline = TACTUS_BASELINE_ACKNOWLEDGED;
  options.key_interval = 0;
  const Sender sender = make_sender(scene, &options);
  const Receiver receiver = make_receiver(scene);
  Truth truth(true);
  std::uint64_t last[2] = {};
  std::uint32_t keys = 0;
  for (std::int64_t tick = 0; tick < 500; ++tick) {
    for (const Packet& packet : encode(sender, tick, truth.at(tick))) {
      EXPECT_EQ(packet.info.number, ++last[packet.info.substream]);
      EXPECT_EQ(packet.info.reserved, 0u);
      if (packet.info.number % 3 == 0) continue;  // lost
      auto info = sized<tactus_packet_info>();
      ASSERT_EQ(push(receiver, packet, TACTUS_PACKET_TICK, &info), TACTUS_OK) << tick;
      EXPECT_EQ(info.number, packet.info.number);
      keys += info.key;
      ASSERT_EQ(tactus_sender_acknowledge(sender.get(), info.substream, info.number, nullptr), TACTUS_OK);
    }
  }
  EXPECT_GT(last[0], 3u);
  EXPECT_GT(last[1], 3u);
  EXPECT_EQ(keys, 2u) << "the first of each; all others build on what was acknowledged";
}

/// A transport that numbers all that it sends: packets have its numbers, and a receiver is told of those that none has.
TEST(CEncoder, ATransportMayGiveTheNumbers) {
  auto unsmoothed = filled<tactus_scene_options>();
  unsmoothed.rigid_profile = TACTUS_PROFILE_THESIS;
  const Scene scene = make_scene(false, &unsmoothed);
  const Sender sender = make_sender(scene);
  auto late = filled<tactus_receiver_options>();
  late.interpolation = TACTUS_INTERPOLATION_PLAYOUT;
  const Receiver receiver = make_receiver(scene, &late), uninformed = make_receiver(scene, &late);
  std::array<tactus_rigid_sample, 2> objects{};
  for (tactus_rigid_sample& object : objects) object.pose.rotation[0] = 1;
  objects[1].pose.position[2] = 0.05;
  auto truth = filled<tactus_truth>();
  truth.objects = objects.data();
  truth.object_count = objects.size();
  constexpr std::uint64_t kFirst = 1000, kEvery = 3;
  const auto x = [&](const Receiver& of, std::int64_t tick) {
    tactus_pose pose{};
    EXPECT_EQ(tactus_receiver_poses(of.get(), tick, 1, 1, &pose, nullptr, nullptr), TACTUS_OK);
    return pose.position[0];
  };
  for (std::int64_t i = 0; i < 3; ++i) {  // it jumps, then rests
    objects[1].pose.position[0] = 0.1 * static_cast<double>(i + 1);
    truth.number = kFirst + kEvery * static_cast<std::uint64_t>(i);
    const auto packets = encode(sender, 10 * i, &truth);
    ASSERT_EQ(packets.size(), 1u);
    EXPECT_EQ(packets[0].info.number, truth.number);
    for (const Receiver* to : {&receiver, &uninformed}) ASSERT_EQ(push(*to, packets[0], TACTUS_PACKET_TICK, nullptr), TACTUS_OK);
    for (std::uint64_t none = 1; none < kEvery; ++none)
      ASSERT_EQ(tactus_receiver_push(receiver.get(), truth.number + none, nullptr, 0, TACTUS_PACKET_TICK, nullptr, nullptr),
                TACTUS_OK);
  }
  EXPECT_NEAR(x(receiver, 5), 0.1, 1e-3) << "no packet was lost: it rests until the next update";
  EXPECT_NEAR(x(uninformed, 5), 0.15, 1e-3) << "a packet may be lost: a way from one update to the next";
  EXPECT_REFUSED("R-API-5", tactus_receiver_push, receiver.get(), 0, nullptr, 0, TACTUS_PACKET_TICK, nullptr);
  auto encoded = sized<tactus_encoded>();
  truth.number = kFirst;
  EXPECT_REFUSED("R-API-5", tactus_sender_encode, sender.get(), 30, &truth, &encoded);
}

/// What is reserved is for a later version: a program that sets it expects what this library does not do.
TEST(CEncoder, WhatIsReservedIsZero) {
  const Scene scene = make_scene();
  auto options = filled<tactus_sender_options>();
  options.reserved = 1;
  tactus_sender* raw = nullptr;
  EXPECT_REFUSED("R-API-12", tactus_sender_create, scene.get(), &options, &raw);
}

/// What is left open depends on the bound that is declared.
TEST(CEncoder, NearlyExactMeshesFadeNothing) {
  const Hinge hinge;
  auto coding = filled<tactus_deformable_options>();
  std::vector<std::uint8_t> clusters;
  ASSERT_EQ(hinge.find(4, coding, clusters), TACTUS_OK);
  const auto declared = [&](double visual) {
    auto bounds = filled<tactus_deformable_bounds>();
    bounds.visual = visual;
    return parse_scene(written(hinge.scene(coding, &bounds))).value().scene->deformables.at(0);
  };
  EXPECT_GT(declared(1.1e-5).fade, 0);
  EXPECT_EQ(declared(1.1e-5).weight_sets, 2);
  EXPECT_EQ(declared(1e-5).fade, 0);
  EXPECT_EQ(declared(1e-5).weight_sets, 1);
  coding.fade = 0.5;
  coding.weight_sets = 4;
  EXPECT_GT(declared(1e-5).fade, 0);
  EXPECT_EQ(declared(1e-5).weight_sets, 4);
}

}  // namespace
}  // namespace tactus::c_test
