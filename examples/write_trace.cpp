// SPDX-License-Identifier: Apache-2.0
/// A recording of one's own as a trace: a cup that a hand pushes, 2 s at 500 Hz.   usage: write_trace OUT.mcap
#include <cmath>
#include <cstdio>
#include <vector>

#include <tactus/trace/array_trace.h>

int main(int argc, char** argv) {
  if (argc != 2) return std::fprintf(stderr, "usage: write_trace OUT.mcap\n"), 2;
  std::vector<std::int64_t> time;
  std::vector<double> position, rotation, force;
  for (int i = 0; i < 1000; ++i) {
    const double t = i / 500.0;
    time.push_back(2'000'000 * i);  // ns
    for (const double value : {0.05 * std::sin(3 * t), 0.02 * std::cos(2 * t), 0.0}) position.push_back(value);
    for (const double value : {std::cos(t / 2), 0.0, 0.0, std::sin(t / 2)}) rotation.push_back(value);
    for (const double value : {0.0, 0.0, 2 + std::sin(7 * t)}) force.push_back(value);
  }
  tactus::SampledArrays arrays{.time = time, .source = "write_trace"};
  arrays.objects.push_back({.name = "cup", .position = position, .rotation = rotation});
  arrays.users.push_back({.name = "hand", .force = force});
  arrays.contacts.push_back({.user = "hand", .object = "cup", .stiffness = 500, .at = tactus::ForcePoint::origin});
  tactus::ReadNotes notes;  // what was decided: missing samples, times off the grid
  const auto written = tactus::write_arrays(arrays, argv[1], notes);
  if (!written) return std::fprintf(stderr, "%s: %s\n", argv[1], describe(written.error())), 1;
  std::printf("%llu ticks, %zu notes\n", static_cast<unsigned long long>(written->count()), notes.all().size());
}
