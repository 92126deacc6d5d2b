// SPDX-License-Identifier: Apache-2.0
/// What a user of the installed library writes: one packet of an object, there and back; a mesh in halves, one of them dropped.
#include <tactus/rigid/rigid_encoder.h>
#include <tactus/tactus.h>

#include <cstdio>
#include <vector>

namespace {

const char* round_trip() {
  tactus::StreamHeader header;
  header.objects.push_back({.name = "cube", .dof = tactus::Dof::all, .initial = {}});

  auto encoder = tactus::RigidEncoder::create(header);
  auto decoder = tactus::RigidDecoder::create(header);
  if (!encoder || !decoder) return "the header is refused";

  const tactus::RigidSample truth{
      .pose = {.position = {0.25, -0.5, 1.0}, .rotation = {}}, .velocity = {0.1, 0, 0}, .angular_velocity = {}};
  const auto packet = encoder->encode(1, {&truth, 1}, {});
  if (!packet || packet->bytes.empty()) return "a jump of a metre yields no packet";
  if (!decoder->decode(packet->bytes)) return "the packet is refused";

  const tactus::Pose seen = tactus::to_pose(tactus::predict(decoder->objects()[0], 1, header), header.grid);
  if (tactus::norm(seen.position - truth.pose.position) > tactus::RigidTriggers{}.visual_position)
    return "the client sees another place";
  if (decoder->state_hash() != encoder->state_hash()) return "the ends hold different states";
  return nullptr;
}

/// A strip of four triangles, touched at one end.
const char* mesh_in_halves() {
  const tactus::TriMesh strip{.vertices = {{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}, {0.01, 0.01, 0}, {0, 0.02, 0}, {0.01, 0.02, 0}},
                              .triangles = {{0, 1, 3}, {0, 3, 2}, {2, 3, 5}, {2, 5, 4}}};
  tactus::StreamHeader header;
  header.baseline_span = 2;  // so that one packet may be dropped
  auto mesh = tactus::make_deformable_object("strip", strip, header.grid.position);
  if (!mesh) return "the mesh is refused";
  mesh->split = true;
  mesh->rings = 0;
  header.meshes.push_back(*mesh);

  auto encoder = tactus::DeformableEncoder::create(header, 0);
  auto decoder = tactus::DeformableDecoder::create(header, 0);
  if (!encoder || !decoder) return "the header is refused";

  const tactus::SurfaceTouch touch{.triangle = 0, .force = 1, .stiffness = 500};
  for (int frame = 1; frame <= 3; ++frame) {
    const std::vector<tactus::Vec3> truth(6, tactus::Vec3{0, 0, -0.001 * frame});
    const auto felt = encoder->encode(frame, truth, touch);
    if (!felt || felt->half != tactus::Layer::haptic) return "a push of a millimetre yields no haptic half";
    if (!decoder->decode(felt->bytes)) return "a haptic half is refused";
    const tactus::Vec3 seen = tactus::to_metres(decoder->displacements()[0], header.grid.position);
    if (tactus::norm(seen - truth[0]) > tactus::DeformableThresholds{}.visual)
      return "the client sees the touched vertex elsewhere";

    const auto rest = encoder->encode_rest();
    if (rest.half != tactus::Layer::visual) return "a push of a millimetre yields no visual half";
    if (frame == 2) encoder->forget_last();  // the network is slow
    else if (!decoder->decode(rest.bytes)) return "a visual half is refused";
    if (decoder->state_hash() != encoder->state_hash()) return "the ends hold different states of the mesh";
  }
  return nullptr;
}

}  // namespace

int main() {
  const char* complaint = round_trip();
  if (!complaint) complaint = mesh_in_halves();
  std::puts(complaint ? complaint : "one packet, there and back; a mesh in halves");
  return complaint ? 1 : 0;
}
