// SPDX-License-Identifier: Apache-2.0
/// A client that simulates the scene itself allocates nothing while it does.
#include <tactus/sim/prediction/prediction.h>

#include <gtest/gtest.h>

#include "tests/property/allocated.h"

namespace tactus::sim {
namespace {

TEST(PredictionMemory, NothingIsAllocatedWhileACubeIsPushedAndCorrected) {
  const Scene scene = load_scene(*find_scene("push-cube")).value();
  const auto own = Prediction::create(scene, 0).value();
  std::uint64_t before = 0;
  for (std::int64_t tick = 0; tick < 3000; ++tick) {
    if (tick == 300) before = testing::allocated_bytes();  // ODE has its arenas
    const double x = 2e-5 * static_cast<double>(tick);
    own->hear(0, {{tick < 1000 ? 0 : x / 2, 0, 0.02}, {}}, tick);
    own->push(0, {0, tick % 2 == 0 ? 0.1 : 0.0, 0});
    own->correct(50);
    own->step({.position = {-0.03 + x, 0, 0.02}});
  }
  EXPECT_GT(own->poses()[0].position.x, 0.005) << "the cube is pushed";
  EXPECT_EQ(testing::allocated_bytes(), before);
}

}  // namespace
}  // namespace tactus::sim
