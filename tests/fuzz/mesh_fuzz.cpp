// SPDX-License-Identifier: Apache-2.0
/// Any bytes as packets of small meshes.
#include <cstdlib>
#include <vector>

#include "codec/mesh/mesh.h"
#include "codec/mesh/mesh_decoder.h"
#include "tests/fuzz/packets.h"

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
  mesh.split = (choice & 129) == 128;
  header.meshes.push_back(mesh);
  return header;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  auto decoder = MeshDecoder::create(scene(data[0]), 0);
  auto twin = MeshDecoder::create(scene(data[0]), 0);
  if (!decoder || !twin) std::abort();
  decode_packets({data + 1, size - 1}, *decoder, *twin, [&](const DecodedMeshPacket& packet) {
    for (const auto& u : decoder->displacements_at(packet.tick + 1 + data[0]))
      for (const std::int32_t c : u)
        if (std::abs(c) > MeshObject::kMaxDisplacement) std::abort();
  });
  return 0;
}
