// SPDX-License-Identifier: Apache-2.0
/// Scenes of several parts: spec/60-mesh.md section 1.
#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/mesh_build.h"

namespace tactus::conformance {
namespace {

Bytes of_part(std::uint8_t part, const Bytes& packet) { return Bytes{part} + packet; }

RawHeader cubes() {
  RawHeader header;
  header.objects = {{"cube"}, {"wall", Dof::none}, {"slider", Dof::x}};
  header.baseline_span = 2;
  return header;
}

RawMesh sheet_mesh() { return {.shape = sheet(3, 3), .name = "sheet"}; }
RawMesh box_mesh() { return {.shape = box(2, 1, 1), .profile = 0, .name = "box", .models_kept = 1}; }

/// Packets of the rigid objects and of two meshes in turn; each part counts its own.
Stream three_parts(int rounds) {
  Stream stream(with_meshes(cubes(), {box_mesh(), sheet_mesh()}));
  MeshComposer box_part(stream.header(), 0), sheet_part(stream.header(), 1);
  Random random(660);
  for (std::int64_t i = 0; i < rounds; ++i) {
    const bool key = i % 6 == 0;
    const std::uint32_t object = i % 2 == 0 ? 0 : 2;
    const Step rigid{.tick = 3 * i, .updates = {random_update(random, stream.header(), object)}, .key = key};
    stream.add_packet(3 * i, of_part(0, stream.packet(rigid)), key);
    if (i % 3 != 2) {
      const ThesisStep step{.at = {.tick = 3 * i, .key = key}, .vertices = {{random.below(8), {1, random.below(256), 3}}}};
      stream.add_packet(3 * i, of_part(1, box_part.packet(step)), key);
    }
    const MainStep step{.at = {.tick = 3 * i + 1, .key = key},
                        .triangle = random.below(18),
                        .haptic = 30,
                        .visual = 200,
                        .residuals = random_residuals(random, 4, 90)};
    stream.add_packet(3 * i + 1, of_part(2, sheet_part.packet(step)), key);
  }
  return stream;
}

/// Two meshes and no object that moves: parts 1 and 2.
Bytes two_meshes() {
  RawHeader header;
  header.objects = {{"table", Dof::none}};
  Stream stream(with_meshes(header, {sheet_mesh(), {.shape = one_vertex(), .name = "drop"}}));
  MeshComposer sheet_part(stream.header(), 0), drop_part(stream.header(), 1);
  Random random(661);
  for (std::int64_t i = 0; i < 5; ++i) {
    const MainStep step{.at = {.tick = i, .key = i == 0}, .residuals = random_residuals(random, 4, 120)};
    stream.add_packet(i, of_part(2, drop_part.packet(step)), step.at.key);
    if (i % 2 == 0) stream.add_packet(i, of_part(1, sheet_part.packet(step)), step.at.key);
  }
  return stream.finish().bytes();
}

Bytes beside_static_objects() {
  RawHeader header;
  header.objects = {{"table", Dof::none}, {"wall", Dof::none}};
  header = with_meshes(header, {sheet_mesh()});
  header.extensions = varint(7) + varint(2) + Bytes{1, 2};
  MeshStream stream(header);
  Random random(662);
  for (std::int64_t i = 0; i < 4; ++i)
    stream.add(MainStep{.at = {.tick = i, .key = i == 0}, .residuals = random_residuals(random, 4, 120)});
  return stream.finished();
}

Bytes then(const Bytes& packet) { return three_parts(1).add_packet(1, packet).bytes(); }

}  // namespace

void add_mesh_parts(Catalogue& c) {
  c.valid("parts", "Rigid objects and meshes of both profiles in one stream.", three_parts(14).finish().bytes(), {"R-PKT-6"});
  c.valid("parts-shown", "The same, and what a client shows of all.", three_parts(8).finish().bytes(), {}, "linear");
  c.valid("two-meshes", "Two meshes and a static object: parts 1 and 2.", two_meshes(), {"R-PKT-6"});
  c.valid("beside-static-objects", "A mesh beside static objects is the only part; an extension follows the mesh.",
          beside_static_objects());
  c.valid("parts-without-packets", "A stream of three parts and no packet: every initial state.",
          with_meshes(cubes(), {sheet_mesh(), box_mesh()}).bytes());
  const Rejection no_part{"invalid", "R-PKT-6"};
  c.invalid("no-part-byte", "A packet of no byte in a scene of three parts.", {"truncated", "R-PKT-6"}, then({}));
  c.invalid("part-3", "Part 3 of 0, 1 and 2.", no_part, then({3, 1, 0}));
  c.invalid("part-255", "Part 255, and nothing more.", no_part, then({255}));
  RawHeader still;
  still.objects = {{"table", Dof::none}};
  c.invalid("part-0-without-objects", "Part 0 where no object moves.", no_part,
            Stream(with_meshes(still, {sheet_mesh(), box_mesh()})).add_packet(0, {0, 0, 0}).bytes());
  c.invalid("part-and-half-a-sequence", "A part's number and one byte.", {"truncated", "R-PKT-2"}, then({2, 1}));
  c.invalid("part-stale", "A packet of part 2 with the sequence number of the one before; part 0 has none such.",
            {"state", "R-PKT-5"}, then({2, 0, 0}));
}

}  // namespace tactus::conformance
