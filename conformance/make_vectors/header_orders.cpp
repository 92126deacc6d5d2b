// SPDX-License-Identifier: Apache-2.0
/// Two faults of a header or of a record at once: the one that is read first counts. More of them are in orders.cpp.
#include <utility>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/mesh_build.h"

namespace tactus::conformance {
namespace {

void add_frame(Catalogue& c) {
  const Rejection cut{"truncated", "R-STR-5"};
  c.invalid("magic-before-cut", "Five bytes, the first of which is not the magic's.", {"malformed", "R-STR-1"},
            first(changed_header([](RawHeader& h) { h.magic[0] = 0x88; }), 5));
  c.invalid("crc-before-body", "tick_rate is 0, and the check value is wrong.", {"checksum", "R-STR-15"},
            with_last_bit_flipped(changed_header([](RawHeader& h) { h.tick_rate = 0; })));
  RawHeader still;
  still.tick_rate = 0;
  c.invalid("cut-before-rate", "tick_rate is 0; the body ends before object_count.", cut, still.around(first(still.body(), 11)));
  c.invalid("extrapolation-before-span", "max_extrapolation and baseline_span are 0.", {"invalid", "R-STR-8"},
            changed_header([](RawHeader& h) {
              h.max_extrapolation = 0;
              h.baseline_span = 0;
            }));
  c.invalid("span-before-count", "baseline_span is 0, object_count 4097.", {"invalid", "R-STR-9"},
            changed_header([](RawHeader& h) {
              h.baseline_span = 0;
              h.object_count = varint(4097);
            }));
}

void add_objects(Catalogue& c) {
  const Rejection cut{"truncated", "R-STR-5"};
  c.invalid("room-before-kind", "object_count is 2 where a byte is missing for two; the first one's kind is 0.", cut,
            changed_header([](RawHeader& h) {
              h.objects[0] = {.name = "a", .kind = 0};
              h.object_count = Bytes{2};
              h.extensions = Bytes(31, 0);
            }));
  RawHeader long_name;
  long_name.objects[0] = {.name = "ten bytes!", .kind = 2};
  c.invalid("kind-before-cut", "An object of kind 2; the body ends inside its rotation.", {"unsupported", "R-STR-10"},
            long_name.around(without_last(long_name.body(), 8)));
  c.invalid("rotation-before-next-kind", "An object's rotation has length 0, the next one's kind is 2.", {"invalid", "R-STR-13"},
            changed_header([](RawHeader& h) {
              h.objects = {{.name = "a", .rotation = {}}, {.name = "b", .kind = 2}};
            }));
  c.invalid("objects-before-meshes", "An object's dof is 64, and mesh_count 0.", {"invalid", "R-STR-12"},
            changed_header([](RawHeader& h) {
              h.objects[0].dof = 64;
              h.flags = 1;
              h.meshes = {0};
            }));
}

void add_records(Catalogue& c) {
  Stream stream(RawHeader{});
  stream.add({.tick = 1, .key = true});
  const Bytes good = stream.bytes();
  const Rejection cut{"truncated", "R-FIL-2"};
  c.invalid("cut-before-type", "The file ends after a record's type, which is 4.", cut, good + Bytes{4});
  c.invalid("type-before-payload", "A record of unknown type 4 announces 5 bytes; none follows.", {"unsupported", "R-FIL-3"},
            good + Bytes{4, 5});
  c.invalid("trailer-size-before-payload", "A trailer announces 9 bytes; none follows.", {"malformed", "R-FIL-6"},
            good + Bytes{3, 9});
  c.invalid("extension-record-of-2-64", "An extension record announces 2^64 - 1 bytes; three follow.", cut,
            good + Bytes{128} + varint(~std::uint64_t{0}) + Bytes{1, 2, 3});
}

void add_mesh_parameters(Catalogue& c) {
  const Rejection cut{"truncated", "R-STR-5"}, parameter{"malformed", "R-MES-3"};
  c.invalid("split-before-cut", "split is 2, and the body ends after it.", parameter, around({1, 1, 1, 'm', 2, 0, 1, 0, 0, 2}));
  c.invalid("models-kept-before-cut", "models_kept is 2, and the body ends after it.", parameter,
            around({1, 0, 1, 'm', 2, 8, 2}));
  c.invalid("cut-before-rings", "rings is 33; the body ends before vertex_count.", cut,
            around({1, 1, 1, 'm', 33, 0, 1, 0, 0, 0}));
  c.invalid("room-before-rest", "A byte is missing for 3 vertices and 1 triangle; the first rest position is beyond 32 bits.",
            cut, counted(3, 1, zigzag_varint(std::int64_t{1} << 31) + Bytes(6, 0)));
  c.invalid("cut-before-corner", "A corner is the number 9 of 3 vertices; the body ends inside the triangle's last corner.", cut,
            counted(3, 1, Bytes(9, 0) + Bytes{18, 2, 0x82}));
  c.invalid("mode-count-before-room", "65 modes; none follows.", {"invalid", "R-MES-7"}, counted(1, 0, Bytes{0, 0, 0, 65}));
}

void add_mesh_names(Catalogue& c) {
  const Rejection name{"invalid", "R-STR-11"};
  RawMesh mesh = with_modes({.shape = one_vertex(), .name = "a\nb"}, 1, 730);
  mesh.entries.back() = 2048;
  c.invalid("entry-before-name", "A name with a line feed, and an entry of 2048.", {"invalid", "R-MES-7"}, only(mesh).bytes());
  c.invalid("name-before-next-mesh", "A name with a line feed; the next mesh has profile 2.", name,
            around(Bytes{2} + RawMesh{.name = "a\nb"}.bytes() + Bytes{2}));
  RawHeader large;
  large.objects.clear();
  large.baseline_span = 64;
  std::vector<RawMesh> meshes(227, {.shape = one_vertex(), .profile = 0, .quant_bits = 12, .models_kept = 1});
  c.invalid("names-before-states", "227 meshes of one name, whose states take more than 2^28 bytes.", name,
            with_meshes(large, meshes).bytes());
}

}  // namespace

void add_stream_header_orders(Catalogue& c) {
  add_frame(c);
  add_objects(c);
  add_records(c);
}

void add_mesh_header_orders(Catalogue& c) {
  add_mesh_parameters(c);
  add_mesh_names(c);
}

}  // namespace tactus::conformance
