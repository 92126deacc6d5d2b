// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include <tactus/metrics/deformable_errors.h>
#include <tactus/metrics/delay_tolerance.h>
#include <tactus/metrics/errors.h>
#include <tactus/metrics/played_shapes.h>
#include <tactus/metrics/rates.h>
#include "tests/unit/deformable_fixture.h"

namespace tactus {
namespace {

// ==== metrics ====
// What a stream cost, and how far what a client shows is from the truth: metrics/*.h.

TraceInfo one_cube() {
  return {
      .tick_rate = 1000, .objects = {{"cube", Dof::all}, {"table", Dof::none}}, .users = {{"hand"}}, .source = {}, .scene = {}};
}

/// A cube at x = `x`, pressed from above by 1 N: 1 mm deep at 1000 N/m.
TraceFrame pressed(std::int64_t tick, double x) {
  TraceFrame frame{.tick = tick, .objects = std::vector<RigidSample>(2), .users = std::vector<UserSample>(1)};
  frame.objects[0].pose.position = {x, 0, 0};
  frame.users[0].contact = {.kind = ContactKind::surface,
                            .object = 0,
                            .point = {0, 0, 0.02},
                            .normal = {0, 0, 1},
                            .device = {x, 0, 0.019},
                            .stiffness = 1000};
  return frame;
}

Pose moved(const TraceFrame& frame, const Vec3& by) { return {frame.objects[0].pose.position + by, {}}; }

TEST(ErrorSeries, CountsTicksAndRuns) {
  ErrorSeries series;
  std::int64_t tick = 0;
  for (const double error : {1.0, 3.0, 3.0, 1.0, 3.0, 1.0}) {
    series.add(error, error > 2);
    series.add(0, false);
    series.end_tick(tick++);
  }
  series.end_tick(tick++);  // a tick without a sample
  EXPECT_EQ(series.ticks(), 6u);
  EXPECT_EQ(series.ticks_over(), 3u);
  EXPECT_EQ(series.longest_run(), 2u);
  EXPECT_DOUBLE_EQ(series.rms(), std::sqrt(30.0 / 12.0));
  EXPECT_EQ(series.max(), 3.0);
}

TEST(ErrorSeries, RunsCoverTheTicksBetweenSamples) {
  ErrorSeries series;
  for (const std::int64_t tick : {10, 20, 30, 40, 50}) {
    series.add(1, tick != 20);
    series.end_tick(tick);
  }
  EXPECT_EQ(series.ticks_over(), 4u);
  EXPECT_EQ(series.longest_run(), 21u);
}

TEST(TickSpan, CountsWhatIsLeftOut) {
  TickSpan ticks;
  EXPECT_EQ(ticks.length(), 0u);
  for (const std::int64_t tick : {5, 6, 9}) ticks.add(tick);
  EXPECT_EQ(ticks.count(), 3u);
  EXPECT_EQ(ticks.length(), 5u);
  EXPECT_EQ(ticks.left_out(), 2u);
}

TEST(ErrorMetrics, MeasuresPoseAndContactForce) {
  ErrorMetrics fidelity(one_cube(), {.visual_position = 0.006, .weber_fraction = 0.08});
  TraceFrame frame = pressed(0, 0.1);
  const auto add = [&](const Vec3& by) {
    fidelity.add(frame, std::array{moved(frame, by), Pose{{9, 9, 9}, {}}});
    ++frame.tick;
  };
  add({0.007, 0, 0});    // beside the face's normal: seen, without an effect on the force
  add({0, 0, 0.00007});  // 7 % of 1 N
  add({0, 0, -0.0001});  // 10 %
  add({0, 0, 0.0002});   // 20 %, over the curve's 14 % at 1 N
  EXPECT_EQ(fidelity.position().ticks_over(), 1u);
  EXPECT_NEAR(fidelity.position().max(), 0.007, 1e-12);
  EXPECT_EQ(fidelity.force().ticks(), 4u);
  EXPECT_EQ(fidelity.force().ticks_over(), 2u);
  EXPECT_EQ(fidelity.force().longest_run(), 2u);
  EXPECT_EQ(fidelity.perceived().ticks_over(), 1u);
  EXPECT_NEAR(fidelity.force().max(), 0.2, 1e-9);
  EXPECT_NEAR(fidelity.worst_haptic_ratio(), 0.2 / 0.08, 1e-9);
}

TEST(ErrorMetrics, BoundsScaleWithTheLevelOfDetail) {
  ErrorMetrics fidelity(one_cube(), {.visual_position = 0.006, .visual_rotation = 0.03, .haptic = HapticRule::off});
  TraceFrame frame = pressed(0, 0.1);
  const auto add = [&](double by, double angle, std::uint8_t level) {
    Pose shown = moved(frame, {by, 0, 0});
    shown.rotation = {std::cos(angle / 2), 0, 0, std::sin(angle / 2)};
    fidelity.add(frame, std::array{shown, Pose{}}, std::array{level, std::uint8_t{0}});
    ++frame.tick;
  };
  add(0.011, 0.05, 1);
  add(0.013, 0.07, 1);  // both over
  add(0.190, 0.90, 5);
  add(9, 3, kOutOfInterest);
  for (const ErrorSeries* series : {&fidelity.position(), &fidelity.rotation()}) {
    EXPECT_EQ(series->ticks(), 3u);
    EXPECT_EQ(series->ticks_over(), 1u);
  }
  EXPECT_NEAR(fidelity.position().max(), 0.0065, 1e-12);
  EXPECT_NEAR(fidelity.rotation().max(), 0.035, 1e-9);
}

TEST(ErrorMetrics, FixedRuleCountsOnlyInContact) {
  ErrorMetrics fidelity(one_cube(), {.haptic = HapticRule::fixed, .fixed_position = 0.0015});
  TraceFrame frame = pressed(0, 0);
  const std::array shown{moved(frame, {0.002, 0, 0}), Pose{}};
  fidelity.add(frame, shown);
  ++frame.tick;
  frame.users[0].contact.kind = ContactKind::none;
  fidelity.add(frame, shown);
  EXPECT_EQ(fidelity.force().ticks(), 1u);
  EXPECT_EQ(fidelity.force().ticks_over(), 1u);
  EXPECT_NEAR(fidelity.worst_haptic_ratio(), 2.0 / 1.5, 1e-9);
}

TEST(ErrorMetrics, RenderedForcesAgainstTheServers) {
  ErrorMetrics fidelity(one_cube(), {});
  TraceFrame frame = pressed(0, 0);
  fidelity.add_rendered(frame);  // nobody feels anything
  ++frame.tick;
  frame.users[0].server_force = {0, 0, 1};
  frame.users[0].force = {0, 0, 1.13};
  fidelity.add_rendered(frame);
  ++frame.tick;
  frame.users[0].force = {0, 0, 1.15};
  fidelity.add_rendered(frame);
  EXPECT_EQ(fidelity.rendered().ticks(), 2u);
  EXPECT_EQ(fidelity.rendered().ticks_over(), 1u);
}

constexpr double kUnit = 0x1p-22;  // [m] of the grid
std::int32_t units(double metres) { return static_cast<std::int32_t>(std::floor(metres / kUnit + 0.5)); }

TEST(DeformableErrors, CountsByBound) {
  const TriMesh sheet = testing::sheet(8, 8);
  const DeformableThresholds bounds{.visual = 0.001, .weber_fraction = 0.1, .depth_floor = 1e-4};
  DeformableErrors fidelity(sheet, bounds, 0, 22);
  const std::vector<float> truth(3 * sheet.vertices.size());
  std::vector<Vec3i> shown(sheet.vertices.size());
  const Triangle& touched = sheet.triangles[20];
  shown[touched[0]] = {0, 0, units(0.0003)};  // h = 0.1 * 2 mm
  shown[touched[1]] = {0, units(0.0001), 0};
  shown[80] = {units(0.0008), 0, 0};
  fidelity.add(truth, shown, {});
  EXPECT_EQ(fidelity.all().violations, 0u);
  EXPECT_EQ(fidelity.area().vertices, 0u);
  EXPECT_NEAR(fidelity.worst_ratio(), 0.8, kUnit / 0.001);
  fidelity.add(truth, shown, SurfaceTouch{20, 0.2, 100});
  EXPECT_EQ(fidelity.all().violations, 1u);
  EXPECT_EQ(fidelity.area().vertices, 3u);
  EXPECT_EQ(fidelity.area().violations, 1u);
  EXPECT_NEAR(fidelity.area().max, 0.0003, kUnit);
  EXPECT_NEAR(fidelity.area().mse(), (0.0003 * 0.0003 + 0.0001 * 0.0001) / 3, 0.0003 * kUnit);
  EXPECT_NEAR(fidelity.worst_ratio(), 1.5, kUnit / 0.0002);
  EXPECT_NEAR(fidelity.mean_haptic(), 0.0002, 1e-12);
  shown[80] = {units(0.0011), 0, 0};
  fidelity.add(truth, shown, {});
  EXPECT_EQ(fidelity.all().violations, 2u);
  EXPECT_EQ(fidelity.all().vertices, 3 * sheet.vertices.size());
}

TEST(DeformableErrors, BoundsDoNotGoBelowTheGrid) {
  const TriMesh sheet = testing::sheet(1, 1);
  DeformableErrors fidelity(sheet, {.visual = 0, .weber_fraction = {}, .depth_floor = 0}, 3, 10);
  const std::vector<Vec3i> shown(4, Vec3i{7, -3, 0});
  const double unit = 1.0 / 1024, half = 0.5 * unit;
  fidelity.add(testing::moved_by(4, {7 * unit + half, -3 * unit + half, half}), shown, {});
  EXPECT_EQ(fidelity.all().violations, 0u);
  fidelity.add(testing::moved_by(4, {7 * unit + half, -3 * unit + half, 1.01 * half}), shown, {});
  EXPECT_EQ(fidelity.all().violations, 4u);
}

/// A client that has nothing but the rest shape of a sheet.
struct Resting {
  TriMesh mesh = testing::sheet(1, 1);
  SharedScene scene = SceneBuilder().deformable("sheet", mesh).build().value();
  Receiver receiver = Receiver::create(scene).value();
  DeformableErrors errors{mesh, {.visual = 0.001}, 0, scene->grid.position};
};

TEST(PlayedShapes, AreJudgedWhenTheirTickIsShown) {
  Resting client;
  PlayedShapes played(0, std::move(client.errors), 8);
  played.add(0, std::vector<float>(12), {});
  played.look(client.receiver.replica(), 0);
  EXPECT_EQ(played.errors().frames(), 0u) << "it came before anything was shown";
  played.add(10, testing::moved_by(4, {0, 0, 0.0009}), {});
  played.add(20, testing::moved_by(4, {0, 0, 0.0011}), {});
  played.look(client.receiver.replica(), 19);
  EXPECT_EQ(played.errors().frames(), 1u);
  EXPECT_EQ(played.errors().all().violations, 0u);
  played.look(client.receiver.replica(), 25);
  EXPECT_EQ(played.errors().frames(), 2u);
  EXPECT_EQ(played.errors().all().violations, 4u);
}

TEST(PlayedShapes, KeepNoMoreThanAsked) {
  Resting client;
  PlayedShapes played(0, std::move(client.errors), 3);
  played.look(client.receiver.replica(), 0);
  for (std::int64_t tick = 1; tick <= 10; ++tick) played.add(tick, std::vector<float>(12), {});
  played.look(client.receiver.replica(), 10);
  EXPECT_EQ(played.errors().frames(), 3u);
}

TEST(RateMetrics, CountsByStrongestReason) {
  const RigidUpdate updates[] = {{0, Reason::visual, 0}, {1, Reason::haptic, 0}, {2, Reason::heartbeat, 0}};
  DecodedPacket packet;
  EXPECT_EQ(strongest_reason(packet), Reason::request);
  packet.updates = std::span(updates).first(1);
  EXPECT_EQ(strongest_reason(packet), Reason::visual);
  packet.updates = updates;
  EXPECT_EQ(strongest_reason(packet), Reason::haptic);
  RateMetrics traffic;
  traffic.add(strongest_reason(packet), 3, 40, true);
  traffic.add(Reason::visual, 1, 9, false);
  traffic.add(Reason::visual, 2, 11, false);
  EXPECT_EQ(traffic.packets, (std::array<std::uint64_t, 4>{0, 0, 2, 1}));
  EXPECT_EQ(traffic.all_packets(), 3u);
  EXPECT_EQ(traffic.updates, 6u);
  EXPECT_EQ(traffic.bytes, 60u);
  EXPECT_EQ(traffic.keys, 1u);
}

TEST(DeformableRates, Quantiles) {
  DeformableRates traffic;
  EXPECT_EQ(traffic.quantile(0.99), 0u);
  for (std::size_t size = 1; size <= 200; ++size) traffic.add(size, 1, size == 1, size % 2 == 0 ? Layer::haptic : Layer::all);
  EXPECT_EQ(traffic.quantile(0.99), 198u);
  EXPECT_EQ(traffic.quantile(1), 200u);
  EXPECT_EQ(traffic.keys, 1u);
  EXPECT_EQ(traffic.bytes, 20100u);
  EXPECT_EQ(traffic.layers[0].packets, 100u);
  EXPECT_EQ(traffic.layers[0].bytes, 10100u);
  EXPECT_EQ(traffic.layers[1].packets, 0u);
}

// ==== delay tolerance ====

constexpr double kStiffness = 700, kWeber = 0.1;

/// Thesis 4.2.4.1: 18 ms; the Jenga block of 4.2.4.3 (0.3 kg, mu 0.45, d 0.995): 4.0 ms at 0.05 m/s, 2.1 ms at 0.1 m/s.
TEST(TolerableRoundTrip, IsThatOfTheThesis) {
  EXPECT_NEAR(*tolerable_round_trip({-12.6, 0, 0}, {0.1, 0, 0}, kStiffness, kWeber), 0.018, 1e-12);
  const double friction = 0.45 * 0.3 * 9.81, damping = 0.3 * (1 - 0.995 * 0.995) / 2e-3;
  for (const auto& [speed, expected] : {std::pair{0.05, 4.0e-3}, std::pair{0.1, 2.1e-3}}) {
    const auto most = tolerable_round_trip({0, -(friction + damping * speed), 0}, {0, speed, 0}, kStiffness, kWeber);
    ASSERT_TRUE(most);
    EXPECT_NEAR(*most, expected, 5e-5);
  }
}

TEST(TolerableRoundTrip, OnlyMotionAgainstTheForceCounts) {
  const Vec3 force{0, 0, 2};
  EXPECT_FALSE(tolerable_round_trip(force, {0, 0, 0.1}, kStiffness, kWeber)) << "lets go";
  EXPECT_FALSE(tolerable_round_trip(force, {0.3, 0.1, 0}, kStiffness, kWeber)) << "along the surface";
  EXPECT_FALSE(tolerable_round_trip(force, {}, kStiffness, kWeber));
  EXPECT_FALSE(tolerable_round_trip({}, {0, 0, -0.1}, kStiffness, kWeber));
  EXPECT_EQ(tolerable_round_trip(force, {0.3, 0.1, -0.1}, kStiffness, kWeber),
            tolerable_round_trip(force, {0, 0, -0.1}, kStiffness, kWeber));
}

class Tolerance : public ::testing::Test {
 protected:
  Tolerance() {
    info_.objects = {{"cube"}};
    info_.users = {{"hand"}};
    frame_.objects.resize(1);
    frame_.users.resize(1);
  }
  void push(DelayTolerance& tolerance, int ticks, double speed, double force, int step = 1) {
    UserSample& user = frame_.users[0];
    for (int i = 0; i < ticks; ++i) {
      user.device.position.x += 1e-3 * step * speed;
      user.contact.kind = ContactKind::surface;
      user.contact.stiffness = kStiffness;
      user.server_force = {-force, 0, 0};
      tolerance.add(frame_);
      frame_.tick += step;
    }
  }
  TraceInfo info_;
  TraceFrame frame_;
};

TEST_F(Tolerance, CountsTheTicksInWhichARoundTripIsPerceptible) {
  DelayTolerance tolerance(info_, kWeber);
  push(tolerance, 1, 0.1, 12.6);                           // no velocity yet
  for (int i = 0; i < 9; ++i) push(tolerance, 1, 0.1, 0);  // no force
  push(tolerance, 300, 0.1, 12.6);                         // 18 ms
  push(tolerance, 12, 0, 12.6);                            // until it has stopped
  push(tolerance, 100, 0, 12.6);
  ASSERT_EQ(tolerance.touches().size(), 1u);
  const auto& [pair, touch] = *tolerance.touches().begin();
  EXPECT_EQ(pair.object, 0u);
  EXPECT_EQ(touch.ticks(), 421u);
  EXPECT_GE(touch.pressing(), 300u);
  EXPECT_LE(touch.pressing(), 309u);
  EXPECT_NEAR(*touch.quantile(0.5), 0.018, 2e-4);
  EXPECT_EQ(touch.perceptible(0), 0);                    // 10 ms
  EXPECT_NEAR(touch.perceptible(1), 300 / 421.0, 0.01);  // 25 ms
}

TEST_F(Tolerance, APauseIsNoMotion) {
  DelayTolerance tolerance(info_, kWeber);
  push(tolerance, 20, 0, 1);
  frame_.tick += 5000;
  frame_.users[0].device.position.x += 1;
  push(tolerance, 20, 0, 1);
  EXPECT_EQ(tolerance.touches().begin()->second.pressing(), 0u);
  EXPECT_FALSE(tolerance.touches().begin()->second.quantile(0.5));
}

/// 100 Hz: a tick is longer than the window of the velocity.
TEST_F(Tolerance, SparseTicksHaveAVelocityToo) {
  info_.tick_rate = 100;
  DelayTolerance tolerance(info_, kWeber);
  push(tolerance, 50, 1, 12.6);  // 1 mm per tick of 10 ms: 0.1 m/s
  EXPECT_EQ(tolerance.touches().begin()->second.pressing(), 49u);
  EXPECT_NEAR(*tolerance.touches().begin()->second.quantile(0.5), 0.018, 2e-4);
}

TEST_F(Tolerance, MeshesAreApart) {
  info_.meshes.resize(1);
  DelayTolerance tolerance(info_, kWeber);
  SurfaceContact contact;
  contact.stiffness = kStiffness;
  for (int i = 0; i < 10; ++i) {
    frame_.users[0].surface_contact = contact;
    frame_.users[0].device.position.z -= 1e-4;
    frame_.users[0].server_force = {0, 0, 12.6};
    tolerance.add(frame_);
    ++frame_.tick;
  }
  ASSERT_EQ(tolerance.touches().size(), 1u);
  EXPECT_TRUE(tolerance.touches().begin()->first.is_mesh);
  EXPECT_EQ(tolerance.touches().begin()->second.pressing(), 9u);
}

}  // namespace
}  // namespace tactus
