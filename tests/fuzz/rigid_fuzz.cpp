// SPDX-License-Identifier: Apache-2.0
/// Any bytes as packets of four small scenes: two bytes of length, then a packet, again and again.
#include <algorithm>
#include <cstdlib>
#include <vector>

#include "codec/rigid/rigid_decoder.h"

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
  auto twin = RigidDecoder::create(
      scene(data[0]));  // sees accepted packets only: refused ones must leave no trace, not even in baselines
  if (!decoder || !twin) std::abort();
  for (std::size_t at = 1; at + 2 <= size;) {
    const std::size_t length = std::min<std::size_t>(data[at] | (data[at + 1] & 3u) << 8, size - at - 2);
    const std::vector<std::uint8_t> packet(data + at + 2, data + at + 2 + length);
    at += 2 + length;
    const std::uint64_t before = decoder->state_hash();
    const auto decoded = decoder->decode(packet);
    if (!decoded) {
      if (decoded.error().rule[0] != 'R' || decoded.error().bit_offset > 8 * packet.size()) std::abort();
      if (decoder->state_hash() != before) std::abort();
      continue;
    }
    const auto same = twin->decode(packet);
    if (!same || same->final_code != decoded->final_code || twin->state_hash() != decoder->state_hash()) std::abort();
    for (const RigidUpdate& update : decoded->updates) {
      const RigidState& state = decoder->objects()[update.object];
      std::int64_t square = 0;
      for (const std::int32_t c : state.rotation) square += static_cast<std::int64_t>(c) * c;
      if (state.tick != decoded->tick || std::llabs(square - (std::int64_t{1} << 60)) > std::int64_t{1} << 41) std::abort();
    }
  }
  return 0;
}
