// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>

#include <tactus/sim/simulation.h>

namespace tactus::sim {
namespace {

class Hash {
 public:
  void add(double value) { state_ = (state_ ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3; }
  void add(const Vec3& v) { add(v.x), add(v.y), add(v.z); }
  void add(const Quat& q) { add(q.w), add(q.x), add(q.y), add(q.z); }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325;
};

/// Of all that a trace of rigid objects holds.
std::uint64_t hash_of(const char* name, int ticks) {
  Scene scene = load_scene(find_scene(name).value()).value();
  set_tremor(scene, 1e-4);
  auto simulation = Simulation::create(scene, {.seed = 3, .grip = {}, .channel = {}}).value();
  Hash hash;
  for (int tick = 0; tick < ticks; ++tick) {
    EXPECT_TRUE(simulation.step());
    for (const RigidSample& object : simulation.frame().objects) {
      hash.add(object.pose.position), hash.add(object.pose.rotation);
      hash.add(object.velocity), hash.add(object.angular_velocity);
    }
    for (const UserSample& user : simulation.frame().users) hash.add(user.device.position), hash.add(user.force);
  }
  return hash.value();
}

/// The same seed gives the same trace with every compiler, optimisation and C library; ODE's build is that of Debian 12.
TEST(Simulation, GivesTheSameBitsEverywhere) {
  EXPECT_EQ(hash_of("rotate-push-lift", 6000), 4176946784043520963u);
  EXPECT_EQ(hash_of("jenga-together", 3000), 9458888181964656282u);
}

}  // namespace
}  // namespace tactus::sim
