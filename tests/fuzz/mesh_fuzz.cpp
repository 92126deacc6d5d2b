// SPDX-License-Identifier: Apache-2.0
/// Any bytes as packets of four small meshes: two bytes of length, then a packet, again and again.
#include <algorithm>
#include <cstdlib>
#include <vector>

#include "codec/mesh/mesh.h"
#include "codec/mesh/mesh_decoder.h"

namespace {

using namespace tactus;

StreamHeader scene(std::uint8_t choice) {
  TriMesh strip;
  for (std::uint32_t i = 0; i < 24; ++i) strip.vertices.push_back({0.01 * (i / 2), 0.01 * (i % 2), 0});
  for (std::uint32_t i = 0; i + 2 < 24; ++i)
    strip.triangles.push_back(i % 2 == 0 ? Triangle{i, i + 1, i + 2} : Triangle{i + 1, i, i + 2});
  StreamHeader header;
  header.tick_rate = 60;
  MeshObject mesh = make_mesh_object("m", strip, header.grid.position).value();
  if (choice & 1) mesh.profile = MeshProfile::thesis;
  mesh.models_kept = (choice & 2) != 0;
  if ((choice & 3) == 2) {
    std::vector<double> ramp(72);
    for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = static_cast<double>(i) - 20;
    mesh.basis = make_mode_basis(ramp, 1).value();
  }
  if (choice & 4) header.baseline_span = 5;
  header.meshes.push_back(mesh);
  return header;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  auto decoder = MeshDecoder::create(scene(data[0]), 0);
  auto twin = MeshDecoder::create(scene(data[0]), 0);  // sees accepted packets only: refused ones must leave no trace
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
    const std::int64_t later = decoded->tick + 1 + data[0];
    for (const auto& u : decoder->displacements_at(later))
      for (const std::int32_t c : u)
        if (std::abs(c) > MeshObject::kMaxDisplacement) std::abort();
  }
  return 0;
}
