// SPDX-License-Identifier: Apache-2.0
/// Any bytes as packets of scenes with loads: whatever is accepted is within the declared objects and users.
#include <string>

#include <tactus/load/load_state.h>
#include <tactus/packet/packet.h>
#include "tests/fuzz/packets.h"

namespace {

using namespace tactus;

SharedScene scene(std::uint8_t choice) {
  SceneSpec spec;
  for (int i = 0; i < (choice & 1 ? 5 : 1); ++i)
    spec.objects.push_back({"o" + std::to_string(i), i == 1 ? Dof::none : Dof::all, {}});
  if (choice & 2) spec.baseline_span = 5;
  spec.loads =
      LoadSpec{.force_exp = static_cast<std::uint8_t>(choice & 4 ? 20 : 10), .users = static_cast<std::uint8_t>(choice >> 3)};
  return Scene::create(std::move(spec)).value();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const SharedScene shared = scene(data[0]);
  auto receiver = Receiver::create(shared).value();
  auto twin = Receiver::create(shared).value();
  push_packets({data + 1, size - 1}, receiver, twin, [&](const DecodedPacket& packet) {
    if (packet.substream == 0) return;
    require(packet.loads >= 1 && packet.loads <= shared->moving().size());
    for (const std::uint32_t object : shared->moving())
      require(receiver.load(object, packet.tick).size() == vectors_of_load(*shared));
  });
  return 0;
}
