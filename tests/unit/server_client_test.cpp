// SPDX-License-Identifier: Apache-2.0
// Server, link, client and hands taken apart: sim/server.h, sim/client.h, sim/link/link.h, sim/deformable/deformable_probes.h.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <tactus/sim/client.h>
#include <tactus/sim/deformable/stiffness_map.h>
#include <tactus/sim/link/link.h>
#include <tactus/sim/server.h>
#include <tactus/sim/simulation.h>
#include <tactus/sim/user/hand.h>

namespace tactus::sim {
namespace {

Scene shipped(const std::string& name) { return load_scene(find_scene(name).value()).value(); }

void expect_equal(std::span<const Packet> a, std::span<const Packet> b, int tick) {
  ASSERT_EQ(a.size(), b.size()) << "tick " << tick;
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_TRUE(std::ranges::equal(a[i].bytes, b[i].bytes)) << "tick " << tick;
}

/// Poses, shapes and contacts, bit for bit.
void expect_equal(const TraceFrame& a, const TraceFrame& b, int tick) {
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    ASSERT_EQ(a.objects[i].pose.position, b.objects[i].pose.position) << "tick " << tick;
    ASSERT_EQ(a.objects[i].pose.rotation, b.objects[i].pose.rotation) << "tick " << tick;
  }
  ASSERT_EQ(a.meshes.size(), b.meshes.size());
  for (std::size_t i = 0; i < a.meshes.size(); ++i)
    ASSERT_EQ(a.meshes[i].displacements, b.meshes[i].displacements) << "tick " << tick;
  for (std::size_t i = 0; i < a.users.size(); ++i) {
    const UserSample &u = a.users[i], &v = b.users[i];
    ASSERT_EQ(u.contact.kind, v.contact.kind) << "tick " << tick;
    ASSERT_EQ(u.contact.point, v.contact.point) << "tick " << tick;
    ASSERT_EQ(u.device.buttons, v.device.buttons) << "tick " << tick;
    ASSERT_EQ(u.surface_contact.has_value(), v.surface_contact.has_value()) << "tick " << tick;
  }
}

/// Whoever joins the parts by hand gets what Simulation gives, bit for bit: with a codec and without one.
void expect_the_same(const Scene& scene, int ticks) {
  for (const bool coded : {false, true}) {
    SimulationOptions options;
    ServerOptions of_server;
    if (coded) options.channel.emplace(), of_server.codec.emplace();
    auto whole = Simulation::create(scene, options).value();
    const auto server = Server::create(scene, of_server).value();
    const auto client = Client::create(*server, {}).value();
    const PerfectLink link;
    Random seeds(options.seed);
    Hand hand(scene.users[0], scene.users[0].grip, seeds.next());
    int touched = 0;
    for (int tick = 0; tick < ticks; ++tick) {
      const std::vector<DeviceSample> devices{hand.step(client->rendered_force(0), client->watched(0))};
      server->observe();
      server->touch(link.to_server(devices));
      const auto packets = server->encode().value();
      ASSERT_TRUE(coded || packets.empty());
      ASSERT_TRUE(client->receive(link.to_client(packets)));
      client->show(server->frame());
      client->touch(devices);
      ASSERT_TRUE(server->step());
      expect_equal(whole.step().value(), packets, tick);
      expect_equal(whole.frame(), server->frame(), tick);
      const UserSample& user = whole.frame().users[0];
      ASSERT_EQ(user.device.position, devices[0].position) << "tick " << tick;
      ASSERT_EQ(user.device.buttons, devices[0].buttons) << "tick " << tick;
      ASSERT_EQ(user.force, client->rendered_force(0)) << "tick " << tick;
      ASSERT_EQ(user.server_force, server->frame().users[0].server_force) << "tick " << tick;
      touched += norm(user.force) > 0 ? 1 : 0;
    }
    EXPECT_GT(touched, 100);
  }
}

TEST(ServerAndClient, TakenApartDoWhatTheSimulationDoes) { expect_the_same(shipped("push-1dof"), 3000); }
#ifdef TACTUS_WITH_FEM
TEST(ServerAndClient, WithDeformableObjectsToo) { expect_the_same(shipped("membrane-small"), 1500); }
#endif
TEST(ServerAndClient, WithOneDimensionalObjectsToo) {
  Scene scene = shipped("msd-1d");
  scene.users.resize(1);
  expect_the_same(scene, 3000);
}

/// A session's epoch ends, and its receiver with it: the client goes on with what it has, and pushes of others are over.
TEST(RemoteClient, ReadsNoReceiverThatIsGone) {
  for (const CompensationMethod method : {CompensationMethod::stiffness, CompensationMethod::simulation}) {
    Scene scene = shipped("push-cube");
    scene.compensation.emplace().method = method;
    ServerOptions options;
    options.codec.emplace().sessions = true;
    const auto server = Server::create(scene, options).value();
    const auto client = Client::create_remote(*server, 0, scene).value();
    auto receiver = std::make_unique<Receiver>(
        Receiver::create(server->stream_scene(), {.replica = {.interpolation = Interpolation::playout}, .limits = {}}).value());
    const DeviceSample device{.position = {-0.018, 0, 0.02}};
    const auto touch = [&] { client->touch(0, device, {.fraction = 1, .delay = 50}); };
    for (std::int64_t tick = 0; tick < 100; ++tick) {
      client->show(*receiver, tick);
      touch();
    }
    client->show_nothing();
    receiver.reset();
    for (int tick = 0; tick < 100; ++tick) touch();
    EXPECT_TRUE(is_finite(client->rendered_force(0)));
  }
}

#ifdef TACTUS_WITH_FEM
/// The map that clients render by is in the declaration, once, if they do, and in no other stream.
TEST(Server, DeclaresTheStiffnessToClientsThatRenderByIt) {
  Scene scene = shipped("membrane-small");
  ServerOptions options;
  options.codec.emplace();
  const auto declared = [&] { return Server::create(scene, options).value()->stream_scene()->deformables[0].stiffness; };
  EXPECT_TRUE(declared().empty());
  scene.compensation.emplace().method = CompensationMethod::simulation;
  EXPECT_TRUE(declared().empty());
  scene.compensation->method = CompensationMethod::stiffness;
  const auto levels = declared();
  const auto map = stiffness_map(scene.deformables[0]).value().stiffness;
  ASSERT_EQ(levels.size(), map.size());
  for (std::size_t v = 0; v < map.size(); ++v)
    if (std::isinf(map[v])) EXPECT_EQ(levels[v], 0);
    else EXPECT_NEAR(stiffness_of_level(levels[v]) / map[v], 1, 0.036) << v;
}
#endif

/// A surface that stays where it was while the device goes 2 mm deeper in 20 ms: softer by what is declared of it.
TEST(Compensation, RendersASurfaceByTheStiffnessThatIsDeclared) {
  Scene scene;
  scene.users.resize(1);
  scene.compensation.emplace();
  DeformableObject soft = make_deformable_object("a", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}, 22).value(), fixed = soft;
  soft.stiffness.assign(3, stiffness_level(100).value());
  fixed.stiffness.assign(3, stiffness_level(std::numeric_limits<double>::infinity()).value());
  const auto rendered = [&](const DeformableObject* declared) {
    auto compensation = Compensation::create(scene).value();
    const SurfaceContact at{.proxy = {0, 0, 0}, .stiffness = 300};
    Vec3 device;
    for (int tick = 0; tick <= 40; ++tick) {
      device = {0, 0, -1e-4 * tick};
      compensation.move(0, {.position = device});
    }
    const Touch touch{.contact = {}, .surface = at, .proxy = {}, .force = {0, 0, 300 * -device.z}};
    Compensation::Shown shown;
    shown.deformable = declared;
    return compensation.soften(0, touch, device, shown, 20).z;
  };
  const double whole = 300 * 4e-3;
  EXPECT_NEAR(rendered(&soft), whole * (1 - 0.75 * 0.5), 0.02 * whole)
      << "K = 300/400 of the displacement in 20 ms, half of the stretch";
  EXPECT_NEAR(rendered(&fixed), whole, 1e-12) << "it does not move";
  EXPECT_NEAR(rendered(nullptr), whole, 1e-12) << "nothing is declared";
}

/// What a client shows and lets feel needs nothing of the physics: a square, then the same square 2 mm lower.
TEST(DeformableView, ShowsAndRendersWithoutFiniteElements) {
  Scene scene;
  scene.users.resize(1);
  scene.deformables.resize(1);
  scene.deformables[0].stiffness = 100;
  const std::vector<TraceDeformable> objects{
      {"square", {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}}}};
  DeformableView view(scene, objects);
  const auto force_at = [&](double z) { return view.touch(0, {.position = {0.1, 0.2, z}}, false).force.z; };
  EXPECT_EQ(force_at(0.01), 0);
  constexpr double kSkin = 100 * 1e-7;  // [N] the proxy is a sphere that lies on the surface
  EXPECT_NEAR(force_at(-0.003), 0.3, kSkin);
  const std::vector<std::array<std::int32_t, 3>> lower(4, {0, 0, -2});  // x 2^-10 m
  view.show(0, lower, 10);
  EXPECT_NEAR(force_at(-0.003), 0.3 - 100 * 2.0 / 1024, kSkin);
  EXPECT_EQ(view.touch(0, {.position = {0.1, 0.2, -0.003}}, false).surface->mesh, 0U);
}

}  // namespace
}  // namespace tactus::sim
