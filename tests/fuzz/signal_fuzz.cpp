// SPDX-License-Identifier: Apache-2.0
/// Any bytes as samples of a device: what its receiver shows stays within the bounds of the coding.
#include <algorithm>
#include <cmath>
#include <optional>

#include <tactus/session/device_signal.h>
#include <tactus/tactus.h>
#include "tests/fuzz/motions.h"
#include "tests/fuzz/require.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tactus;
  ByteReader in({data, size});
  DeviceCoding coding;
  coding.position = 1e-5 * in.u16();
  coding.rotation = 1e-4 * in.u16();
  coding.weber_fraction = 0.002 * in.u8();
  const bool velocity = in.u8() & 1;
  const SharedScene scene = device_scene({}).value();
  auto sender = Sender::create(scene, device_sender_options(coding));
  if (!sender) return 0;
  auto receiver = Receiver::create(scene).value();
  DeviceTruth truth(scene->tick_rate, velocity);
  RigidSample moved;
  for (std::int64_t tick = 0; in.ok(); tick += 1 + in.u8() % 8) {
    move(in, moved);
    DeviceSample sample;
    sample.position = moved.pose.position;
    sample.orientation = moved.pose.rotation;
    sample.velocity = moved.velocity;
    std::optional<DeviceContact> touched;
    if (in.u8() & 1) touched = DeviceContact{contact(in, moved.pose).point, 1.0 + in.u16()};
    const Vec3 displacement = sample.position - device_at(receiver, tick, 0).position;
    const auto packets = sender->encode(tick, truth.of(tick, sample, touched));
    require(packets.has_value());
    for (const Packet& packet : *packets) require(receiver.push(packet.number, packet.bytes).has_value());
    const bool is_held = std::ranges::any_of(sender->held(), [](const HeldPart& h) { return h.part == TruthPart::object; });
    const bool is_near = std::abs(displacement.x) < 511 && std::abs(displacement.y) < 511 &&
                         std::abs(displacement.z) < 511;  // what an update can name
    if (is_held || !is_near) continue;
    const DeviceSample shown = device_at(receiver, tick, 0);
    require(norm(shown.position - sample.position) <= coding.position);
    require(angle_between(shown.orientation, sample.orientation) <= coding.rotation);
  }
  return 0;
}
