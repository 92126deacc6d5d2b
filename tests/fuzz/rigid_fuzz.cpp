// SPDX-License-Identifier: Apache-2.0
/// Any bytes as packets of four small scenes.
#include <cstdlib>
#include <vector>

#include <tactus/rigid/rigid_decoder.h>
#include "tests/fuzz/packets.h"

namespace {

using namespace tactus;

StreamHeader scene(std::uint8_t choice) {
  StreamHeader header;
  const std::vector<std::vector<std::uint8_t>> dofs{
      {Dof::all}, {Dof::x}, {Dof::rz, Dof::none, Dof::all}, std::vector<std::uint8_t>(20, Dof::all)};
  for (const std::uint8_t dof : dofs[choice % dofs.size()]) {
    header.objects.push_back({"o" + std::to_string(header.objects.size()), dof, {}});
  }
  if (choice & 4) header.baseline_span = 5;
  if (choice & 8) header.grid = {30, 18, 28, 16};
  return header;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  auto decoder = RigidDecoder::create(scene(data[0]));
  auto twin = RigidDecoder::create(scene(data[0]));
  if (!decoder || !twin) std::abort();
  decode_packets({data + 1, size - 1}, *decoder, *twin, [&](const DecodedPacket& packet) {
    for (const RigidUpdate& update : packet.updates) {
      const RigidState& state = decoder->objects()[update.object];
      std::int64_t square = 0;
      for (const std::int32_t c : state.rotation) square += static_cast<std::int64_t>(c) * c;
      if (state.tick != packet.tick || std::llabs(square - (std::int64_t{1} << 60)) > std::int64_t{1} << 41) std::abort();
    }
  });
  return 0;
}
