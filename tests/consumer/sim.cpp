// SPDX-License-Identifier: Apache-2.0
/// A user of the component sim: the whole of each scene named, with the codec between server and client.
#include <tactus/sim/simulation.h>

#include <cstdint>
#include <cstdio>
#include <string>

namespace {

std::string run(const char* file) {
  const auto scene = tactus::sim::load_scene(file);
  if (!scene) return tactus::to_string(scene.error());
  tactus::sim::SimulationOptions options;
  options.channel.emplace();
  auto simulation = tactus::sim::Simulation::create(*scene, options);
  if (!simulation) return simulation.error().rule;
  std::size_t sent = 0;
  for (std::int64_t i = 0; i < simulation->ticks(); ++i) {
    const auto packets = simulation->step();
    if (!packets) return packets.error().error.rule;
    for (const tactus::Packet& packet : *packets) sent += packet.bytes.size();
  }
  return sent > 0 ? "" : "nothing was sent";
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string complaint = run(argv[i]);
    std::printf("%s: %s\n", argv[i], complaint.empty() ? "done" : complaint.c_str());
    if (!complaint.empty()) return 1;
  }
  return 0;
}
