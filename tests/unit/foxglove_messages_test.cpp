// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/foxglove_writer.h>

#include <gtest/gtest.h>

#include <tactus/trace/messages.h>

namespace tactus {
namespace {

/// Skips an entity up to its arrows and hands out the first one's pose and lengths.
TEST(FoxgloveMessages, ArrowsPointAlongTheForce) {
  for (const Vec3 along : {Vec3{0, 0, -2}, Vec3{3, 0, 0}, Vec3{-3, 0, 0}, Vec3{-1, 2, 0.5}}) {
    const foxglove::Entity entity{.frame = "world", .id = "e", .arrows = {{{1, 2, 3}, along, 0.1, {}}}};
    std::vector<std::uint8_t> message;
    foxglove::encode_scene_update(message, 1'500'000'000, {&entity, 1});
    CdrReader in(message);
    EXPECT_EQ(in.u32(), 0u);  // deletions
    EXPECT_EQ(in.u32(), 1u);
    EXPECT_EQ(in.u32(), 1u);  // seconds
    EXPECT_EQ(in.u32(), 500'000'000u);
    EXPECT_EQ(in.text(), "world");
    EXPECT_EQ(in.text(), "e");
    EXPECT_EQ(in.u32() + in.u32(), 0u);  // lifetime
    EXPECT_EQ(in.u8(), 0u);
    EXPECT_EQ(in.u32(), 0u);  // metadata
    EXPECT_EQ(in.u32(), 1u);
    const Pose pose = in.pose();
    EXPECT_EQ(pose.position, (Vec3{1, 2, 3}));
    const double shaft = in.f64(), thickness = in.f64(), head = in.f64();
    EXPECT_EQ(thickness, 0.1);
    EXPECT_LT(norm(rotate(pose.rotation, {shaft + head, 0, 0}) - along), 1e-12);
  }
}

}  // namespace
}  // namespace tactus
