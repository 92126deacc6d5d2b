// SPDX-License-Identifier: Apache-2.0
/// A client of one object that got three updates: what it costs to show the object and to take over another update.
#pragma once

#include <benchmark/benchmark.h>

#include <cstdint>

#include <tactus/client/replica.h>
#include <tactus/rigid/rigid_states.h>
#include "tests/unit/rigid_fixture.h"

namespace tactus {

inline Replica with_update(Interpolation mode, const Scene& scene, const ThesisComponent* thesis) {
  Replica replica(scene, {.interpolation = mode}, {}, nullptr, thesis);
  const RigidUpdate named{0, Reason::visual, 0};
  DecodedPacket packet;
  packet.updates = {&named, 1};
  packet.number = 1;
  RigidStates states = initial_states(scene);
  for (std::int64_t tick = 0; tick <= 400; tick += 200) {
    packet.tick = states.tick = tick;
    const RigidSample sample{{{0.001 * static_cast<double>(tick), 0, 0}, {}}, {0.1, 0, 0}, {0, 1, 2}};
    states.objects.set(0, to_grid(sample, tick, scene.grid).value());
    replica.apply(packet, states, tick);
    packet.number += 2;  // every other packet is missing
  }
  return replica;
}

/// in   first  the tick from which the object is shown, for 90 ticks, over and over
inline void show_object(benchmark::State& state, Interpolation mode, std::int64_t first,
                        const ThesisComponent* thesis = nullptr) {
  const SharedScene scene = testing::scene_of(1);
  const Replica replica = with_update(mode, *scene, thesis);
  std::int64_t tick = 0;
  for (auto _ : state) benchmark::DoNotOptimize(replica.pose(0, first + tick++ % 90));
}

inline void apply_update(benchmark::State& state, Interpolation mode, const ThesisComponent* thesis = nullptr) {
  const SharedScene scene = testing::scene_of(1);
  Replica replica = with_update(mode, *scene, thesis);
  const RigidUpdate named{0, Reason::visual, 0};
  DecodedPacket packet;
  packet.updates = {&named, 1};
  packet.number = 10;
  RigidState next = to_grid({{{0.5, 0, 0}, {}}, {0.1, 0, 0}, {0, 1, 2}}, 1000, scene->grid).value();
  RigidStates states = initial_states(*scene);
  std::int64_t tick = 1000;
  for (auto _ : state) {
    packet.tick = next.tick = states.tick = tick;
    ++packet.number;
    states.objects.set(0, next);
    replica.apply(packet, states, tick);
    tick += 200;
  }
}

}  // namespace tactus
