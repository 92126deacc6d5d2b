// SPDX-License-Identifier: Apache-2.0
#include <tactus/metrics/compare.h>

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include <tactus/rigid/rigid_encoder.h>

namespace tactus {
namespace {

TraceInfo one_cube() {
  return {.tick_rate = 1000, .objects = {{"cube", Dof::all}, {"table", Dof::none}}, .users = {"hand"}, .source = {}, .scene = {}};
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
  add({0.007, 0, 0});    // beside the face's normal: seen, not felt
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

TEST(StreamHeaderOfTrace, TakesFirstPosesAtRest) {
  TraceFrame frame = pressed(7, 0.25);
  frame.objects[0].velocity = {1, 0, 0};
  const auto header = stream_header(one_cube(), frame);
  ASSERT_TRUE(header);
  EXPECT_EQ(header->max_extrapolation, 2000);
  EXPECT_EQ(header->objects[0].initial.position[0], 1 << 20);
  EXPECT_EQ(header->objects[0].initial.velocity[0], 0);
  EXPECT_EQ(header->objects[1].dof, Dof::none);
  frame.objects.pop_back();
  EXPECT_STREQ(stream_header(one_cube(), frame).error().rule, "R-API-5");
}

/// Stream of a cube that jumps 1 m at tick 10 and again at 20; `record_offset` is added to the ticks of the file's records.
std::string jumping_stream(std::int64_t record_offset) {
  const StreamHeader header = *stream_header(one_cube(), pressed(0, 0));
  auto encoder = *RigidEncoder::create(header, {.triggers = {.heartbeat = 0, .haptic = HapticRule::off}});
  std::ostringstream out;
  auto writer = *StreamFileWriter::create(out, header);
  for (std::int64_t tick = 0; tick < 30; ++tick) {
    const std::int64_t leap = tick / 10;
    const auto packet = encoder.encode(tick, pressed(tick, static_cast<double>(leap)).objects, {});
    if (packet->bytes.empty()) continue;
    EXPECT_TRUE(writer.add(tick + record_offset, packet->bytes, packet->key));
  }
  EXPECT_TRUE(writer.finish());
  return out.str();
}

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

TEST(StreamPlayer, AppliesPacketsWhenTheyAreDue) {
  const std::string file = jumping_stream(0);
  auto player = *StreamPlayer::open(bytes_of(file));
  EXPECT_EQ(*player.next_tick(), 10);
  EXPECT_FALSE(*player.play(9));
  EXPECT_NEAR(player.pose(0, 9).position.x, 0, 1e-6);
  const auto played = player.play(10);
  ASSERT_TRUE(played && *played);
  EXPECT_EQ(strongest_reason((*played)->packet), Reason::visual);
  EXPECT_TRUE((*played)->packet.key);
  EXPECT_NEAR(player.pose(0, 10).position.x, 1, 0.006);
  EXPECT_EQ(*player.next_tick(), 20);
  EXPECT_TRUE(*player.play(25));
  EXPECT_FALSE(player.complete());
  EXPECT_EQ(*player.next_tick(), std::nullopt);
  EXPECT_TRUE(player.complete());
}

TEST(StreamPlayer, RefusesARecordWithAnotherTickThanItsPacket) {
  const std::string file = jumping_stream(1);
  auto player = *StreamPlayer::open(bytes_of(file));
  const auto played = player.play(11);
  ASSERT_FALSE(played);
  EXPECT_EQ(played.error().code, Errc::invalid);
  EXPECT_STREQ(played.error().rule, "R-FIL-7");
  EXPECT_GT(played.error().bit_offset, 0u);
}

}  // namespace
}  // namespace tactus
