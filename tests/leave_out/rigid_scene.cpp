// SPDX-License-Identifier: Apache-2.0
/// Runs a scene for so many ticks, with codec, and prints a hash of what happened: rigid_scene SCENE TICKS
#include <bit>
#include <cstdio>
#include <cstdlib>

#include <tactus/base/bytes.h>
#include <tactus/sim/simulation.h>

/// From set-up to the last tick; the name is what callgrind is told to count.
extern "C" [[gnu::noinline]] int run_scene(const tactus::sim::Scene& scene, int ticks) {
  tactus::sim::SimulationOptions options;
  options.channel.emplace();
  auto simulation = tactus::sim::Simulation::create(scene, options);
  if (!simulation) {
    std::fprintf(stderr, "%s\n", simulation.error().rule);
    return 1;
  }
  tactus::Fnv1a hash;
  for (int i = 0; i < ticks; ++i) {
    if (!simulation->step()) return 1;
    for (const tactus::RigidSample& object : simulation->frame().objects)
      for (const double x : {object.pose.position.x, object.pose.position.y, object.pose.position.z})
        hash.add64(std::bit_cast<std::uint64_t>(x));
  }
  std::printf("%016llx\n", static_cast<unsigned long long>(hash.value()));
  return 0;
}

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const auto scene = tactus::sim::load_scene(argv[1]);
  if (!scene) {
    std::fprintf(stderr, "%s\n", to_string(scene.error()).c_str());
    return 1;
  }
  return run_scene(*scene, std::atoi(argv[2]));
}
