// SPDX-License-Identifier: Apache-2.0
/// Any bytes as packets of four small scenes.
#include <cstdlib>
#include <string>
#include <vector>

#include <tactus/packet/packet.h>
#include "tests/fuzz/packets.h"

namespace {

using namespace tactus;

SharedScene scene(std::uint8_t choice) {
  SceneSpec spec;
  const std::vector<std::vector<std::uint8_t>> dofs{
      {Dof::all}, {Dof::x}, {Dof::rz, Dof::none, Dof::all}, std::vector<std::uint8_t>(20, Dof::all)};
  for (const std::uint8_t dof : dofs[choice % dofs.size()])
    spec.objects.push_back({"o" + std::to_string(spec.objects.size()), dof, {}});
  if (choice & 4) spec.baseline_span = 5;
  if (choice & 16) spec.motion = {{-9000, 1 << 20, -(1 << 28)}, choice & 32 ? 1 : 1 << 18};
  spec.is_smoothed = (choice & 64) != 0;
  if (choice & 128) {
    spec.driven.emplace().bodies.resize(spec.objects.size());
    spec.driven->bodies[0] = {1, 0, {1, 1, 1}, 0, 0};
  }
  if (choice & 8) spec.grid = {30, 18, 28, 16};
  if ((choice & 12) == 12) spec.interest = {1, 1};
  return Scene::create(std::move(spec)).value();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const SharedScene shared = scene(data[0]);
  auto receiver = Receiver::create(shared).value();
  auto twin = Receiver::create(shared).value();
  std::uint64_t newest = 0;
  push_packets({data + 1, size - 1}, receiver, twin, [&](const DecodedPacket& packet) {
    if (packet.number < newest) return;  // reordered: its states are not the current ones
    newest = packet.number;
    for (const RigidUpdate& update : packet.updates) {
      const RigidState& state = receiver.object(update.object);
      std::int64_t square = 0;
      for (const std::int32_t c : state.rotation) square += static_cast<std::int64_t>(c) * c;
      require(state.tick == packet.tick && std::llabs(square - (std::int64_t{1} << 60)) <= std::int64_t{1} << 41);
    }
  });
  return 0;
}
