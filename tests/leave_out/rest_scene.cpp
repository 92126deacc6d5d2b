// SPDX-License-Identifier: Apache-2.0
/// Runs a scene and writes its trace to nowhere; after the first ticks, in which what can rest comes to rest, callgrind is to count:
/// rest_scene SCENE
#include <cstdio>

#include <tactus/sim/simulation.h>
#include <tactus/trace/trace_file.h>

/// The name is what callgrind is told to count.
extern "C" [[gnu::noinline]] bool counted_ticks(tactus::sim::Simulation& simulation, tactus::TraceWriter& trace, int ticks) {
  for (int i = 0; i < ticks; ++i)
    if (!simulation.step() || !trace.write(simulation.frame())) return false;
  return true;
}

/// The same, not counted.
static bool first_ticks(tactus::sim::Simulation& simulation, tactus::TraceWriter& trace, int ticks) {
  for (int i = 0; i < ticks; ++i)
    if (!simulation.step() || !trace.write(simulation.frame())) return false;
  return true;
}

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const auto scene = tactus::sim::load_scene(argv[1]);
  if (!scene) {
    std::fprintf(stderr, "%s\n", to_string(scene.error()).c_str());
    return 1;
  }
  auto simulation = tactus::sim::Simulation::create(*scene);
  if (!simulation) return 1;
  auto trace = tactus::TraceWriter::create("/dev/null", simulation->info());
  if (!trace || !first_ticks(*simulation, *trace, 100) || !counted_ticks(*simulation, *trace, 200)) return 1;
  return trace->finish() ? 0 : 1;
}
