// SPDX-License-Identifier: Apache-2.0
/// Any bytes as packets of a small deformable object.
#include <cmath>
#include <cstdlib>

#include "tests/fuzz/packets.h"
#include "tests/fuzz/strip.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tactus;
  if (size == 0) return 0;
  const SharedScene scene = Scene::create(strip(data[0]), kStripLimits).value();
  auto receiver = Receiver::create(scene).value();
  auto twin = Receiver::create(scene).value();
  push_packets({data + 1, size - 1}, receiver, twin, [&](const DecodedPacket& packet) {
    for (const auto& u : receiver.replica().displacements(0, packet.tick + 1 + data[0]))
      for (const std::int32_t c : u) require(std::abs(c) <= DeformableObject::kMaxDisplacement);
  });
  return 0;
}
