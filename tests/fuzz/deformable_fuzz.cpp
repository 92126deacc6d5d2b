// SPDX-License-Identifier: Apache-2.0
/// Any bytes as packets of a small mesh.
#include <cstdlib>

#include <tactus/deformable/decoder.h>
#include "tests/fuzz/packets.h"
#include "tests/fuzz/strip.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tactus;
  if (size == 0) return 0;
  auto decoder = DeformableDecoder::create(strip(data[0]), 0).value();
  auto twin = DeformableDecoder::create(strip(data[0]), 0).value();
  decode_packets({data + 1, size - 1}, decoder, twin, [&](const DecodedDeformablePacket& packet) {
    for (const auto& u : decoder.displacements_at(packet.tick + 1 + data[0]))
      for (const std::int32_t c : u) require(std::abs(c) <= DeformableObject::kMaxDisplacement);
  });
  return 0;
}
