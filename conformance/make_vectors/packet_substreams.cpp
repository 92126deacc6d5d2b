// SPDX-License-Identifier: Apache-2.0
/// Scenes of several substreams.
#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

Bytes of_substream(std::uint8_t number, const Bytes& packet) { return Bytes{number} + packet; }

RawHeader cubes() {
  RawHeader header;
  header.objects = {{"cube"}, {"wall", Dof::none}, {"slider", Dof::x}};
  header.baseline_span = 2;
  return header;
}

RawDeformable sheet_object() { return {.shape = sheet(3, 3), .name = "sheet"}; }
RawDeformable box_object() { return {.shape = box(2, 1, 1), .profile = 0, .name = "box", .models_kept = 1}; }

/// Packets of the rigid objects and of two deformable ones in turn; each substream counts its own.
Stream three_substreams(int rounds) {
  Stream stream(with_deformables(cubes(), {box_object(), sheet_object()}));
  DeformableComposer box_packets(stream.header(), 0), sheet_packets(stream.header(), 1);
  Random random(660);
  for (std::int64_t i = 0; i < rounds; ++i) {
    const bool key = i % 6 == 0;
    const std::uint32_t object = i % 2 == 0 ? 0 : 2;
    const Step rigid{.tick = 3 * i, .updates = {random_update(random, stream.header(), object)}, .key = key};
    stream.add_packet(3 * i, of_substream(0, stream.packet(rigid)), key);
    if (i % 3 != 2) {
      const ThesisStep step{.at = {.tick = 3 * i, .key = key}, .vertices = {{random.below(8), {1, random.below(256), 3}}}};
      stream.add_packet(3 * i, of_substream(1, box_packets.packet(step)), key);
    }
    const MainStep step{.at = {.tick = 3 * i + 1, .key = key},
                        .triangle = random.below(18),
                        .haptic = 30,
                        .visual = 200,
                        .residuals = random_residuals(random, 4, 90)};
    stream.add_packet(3 * i + 1, of_substream(2, sheet_packets.packet(step)), key);
  }
  return stream;
}

/// Two deformable objects and none that moves: substreams 1 and 2.
Bytes two_deformable_objects() {
  RawHeader header;
  header.objects = {{"table", Dof::none}};
  Stream stream(with_deformables(header, {sheet_object(), {.shape = one_vertex(), .name = "drop"}}));
  DeformableComposer sheet_packets(stream.header(), 0), drop_packets(stream.header(), 1);
  Random random(661);
  for (std::int64_t i = 0; i < 5; ++i) {
    const MainStep step{.at = {.tick = i, .key = i == 0}, .residuals = random_residuals(random, 4, 120)};
    stream.add_packet(i, of_substream(2, drop_packets.packet(step)), step.at.key);
    if (i % 2 == 0) stream.add_packet(i, of_substream(1, sheet_packets.packet(step)), step.at.key);
  }
  return stream.finish().bytes();
}

Bytes beside_static_objects() {
  RawHeader header;
  header.objects = {{"table", Dof::none}, {"wall", Dof::none}};
  header = with_deformables(header, {sheet_object()});
  header.extensions = varint(7) + varint(2) + Bytes{1, 2};
  DeformableStream stream(header);
  Random random(662);
  for (std::int64_t i = 0; i < 4; ++i)
    stream.add(MainStep{.at = {.tick = i, .key = i == 0}, .residuals = random_residuals(random, 4, 120)});
  return stream.finished();
}

Bytes then(const Bytes& packet) { return three_substreams(1).add_packet(1, packet).bytes(); }

/// A packet of 2^20 bytes in substream 0 at tick 2^28: the largest record that there may be.
Input largest_record() {
  Stream stream(with_deformables({}, {sheet_object()}));
  stream.add_packet(0, of_substream(0, stream.packet({.key = true})), true);
  const Bytes head = stream.bytes();
  const std::size_t packet_size = std::size_t{1} << 20;
  const Bytes last = record(1, varint(1 << 28) + of_substream(0, Bytes{1, 0} + Bytes(packet_size - 3, 0) + Bytes{1}));
  return {head + last, {head.size() + 20, {0}, packet_size - 40}};
}

}  // namespace

void add_packet_substreams(Catalogue& c) {
  c.section(section::kSubstreams);
  c.valid("substreams", "Rigid objects and deformable ones of both profiles in one stream.",
          three_substreams(14).finish().bytes(), {"R-PKT-6"});
  c.valid("substreams-shown", "The same, and what a client shows of all.", three_substreams(8).finish().bytes(), {}, "linear");
  c.valid("two-deformable-objects", "Two deformable objects and a static one: substreams 1 and 2.", two_deformable_objects(),
          {"R-PKT-6"});
  c.valid("beside-static-objects", "A deformable object beside static ones is the only substream; an extension follows it.",
          beside_static_objects());
  c.valid("substreams-without-packets", "A stream of three substreams and no packet: every initial state.",
          with_deformables(cubes(), {sheet_object(), box_object()}).bytes());
  c.invalid("largest-record", "A packet record of 2^20 + 6 bytes, as many as there may be: most are left over.",
            {"malformed", "R-RNG-2"}, largest_record());
  const Rejection unknown{"invalid", "R-PKT-6"};
  c.invalid("no-substream-byte", "A packet of no byte in a scene of three substreams.", {"truncated", "R-PKT-6"}, then({}));
  c.invalid("substream-3", "Substream 3 of 0, 1 and 2.", unknown, then({3, 1, 0}));
  c.invalid("substream-255", "Substream 255, and nothing more.", unknown, then({255}));
  RawHeader still;
  still.objects = {{"table", Dof::none}};
  c.invalid("substream-0-without-objects", "Substream 0 where no object moves.", unknown,
            Stream(with_deformables(still, {sheet_object(), box_object()})).add_packet(0, {0, 0, 0}).bytes());
  c.invalid("substream-and-half-a-sequence", "A substream's number and one byte.", {"truncated", "R-PKT-2"}, then({2, 1}));
  c.invalid("substream-late", "A packet of substream 2 with the sequence number of the one before; substream 0 has none such.",
            {"state", "R-PKT-5"}, then({2, 0, 0}));
}

}  // namespace tactus::conformance
