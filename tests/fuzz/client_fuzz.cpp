// SPDX-License-Identifier: Apache-2.0
/// Any sequence of states, gaps and delays shown by every kind of replica: always a unit rotation, and the state itself once time has
/// passed.
#include <cstdlib>
#include <cstring>

#include <tactus/client/replica.h>
#include <tactus/rigid/device_path.h>
#include <tactus/rigid/rigid_states.h>
#include <tactus/scene/scene_builder.h>
#include <tactus/thesis/thesis.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tactus;
  SceneSpec spec;
  spec.objects.push_back({"o", Dof::all, {}});
  spec.is_smoothed = size > 0 && data[0] / 5 % 2 == 1;
  if (size > 0 && data[0] / 10 % 2 == 1) spec.motion = {{-9000, 1 << 20, -(1 << 28)}, 1 << 18};
  const bool has_device = size > 0 && data[0] / 20 % 2 == 1;
  if (has_device) spec.driven = {{{1075200, 116053, {286331, 286331, 1}, 128, 1049}}};
  const SharedScene scene = Scene::create(std::move(spec)).value();
  DevicePath path(device_scene(*scene).value());
  path.shift(0, 3);
  const DevicePath* known = has_device ? &path : nullptr;
  RigidPredictor predictor(*scene, known);
  ReplicaOptions options;
  constexpr Interpolation kInterpolations[] = {Interpolation::none, Interpolation::linear, Interpolation::playout,
                                               Interpolation::hermite, Interpolation::blending};
  if (size > 0) options.interpolation = kInterpolations[data[0] % 5];
  if (!Replica::check(options, *scene, &thesis_component)) options.interpolation = Interpolation::none;
  Replica replica(*scene, options, {}, known, &thesis_component);
  constexpr std::size_t kStep = 40;
  std::int64_t now = 0;
  std::uint64_t number = 1;
  for (std::size_t at = 1; at + kStep <= size; at += kStep) {
    std::int32_t v[10];
    std::memcpy(v, data + at, sizeof v);
    RigidState state;
    state.tick = now += static_cast<std::uint16_t>(v[0]) % 3000;
    now += v[0] & 0x70000 ? 0 : 7;  // applied late
    if (scene->is_smoothed)
      state.smoothing_exp = static_cast<std::uint8_t>(v[0] >> 22 & 7), state.retained = static_cast<std::uint8_t>(v[0] >> 25 & 3);
    if (scene->motion) state.predictor = static_cast<Predictor>((static_cast<std::uint32_t>(v[0]) >> 27) % 3);
    if (has_device) state.predictor = static_cast<Predictor>(scene->motion ? v[1] & 3 : 3 * (v[1] & 1));
    state.position = {v[1], v[2], v[3]};
    state.velocity = {v[4], v[5], v[6]};
    state.angular_velocity = {v[7] % kAngularVelocityLimit, v[8] % kAngularVelocityLimit, v[9] % kAngularVelocityLimit};
    if (scene->driven) {
      state.contact = {(v[2] & 1) != 0, {v[4] >> 20, v[5] >> 20, v[6] >> 20}, {v[7] >> 11, v[8] >> 11, v[9] >> 11}, v[3] >> 20};
      RigidState device = state;
      device.position[0] ^= v[9] & 0x1ffff;
      device.predictor = Predictor::linear;  // its scene declares no other
      path.add(number + 1, device);
      if (v[0] & 1)
        path.settle(number + 1, [&](std::uint64_t of) { return (static_cast<std::uint64_t>(v[5]) >> of % 32 & 1) != 0; });
    }
    const RigidUpdate update{0, Reason::visual, 0};
    DecodedPacket packet;
    packet.tick = state.tick;
    packet.number = number += static_cast<std::uint32_t>(v[0]) >> 20 & 3;  // packets in between are missing
    packet.updates = {&update, 1};
    replica.apply(packet, RigidStates{packet.tick, PagedArray<RigidState>(1, 1, [&](std::size_t) { return state; })}, now);
    for (const std::int64_t later : {-5000, -250, -30, -1, 0, 1, 10, 99, 5000}) {
      const RigidPose shown = replica.pose(0, now + later);
      double square = 0;
      for (const std::int32_t c : shown.rotation) square += static_cast<double>(c) * c;
      if (square < 0.999 * 1152921504606846976.0 || square > 1.001 * 1152921504606846976.0) std::abort();
    }
    if (replica.pose(0, now + 5000) != predictor.shown(0, state, now + 5000)) std::abort();
  }
  return 0;
}
