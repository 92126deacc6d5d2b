// SPDX-License-Identifier: Apache-2.0
/// Two faults of a scene declaration at once: the one that is read first counts.
#include "conformance/make_vectors/catalogue.h"

namespace tactus::conformance {
namespace {

void add_frame(Catalogue& c) {
  c.invalid("cut-before-version", "Eleven bytes, of version 2.", {"truncated", "R-STR-5", "R-STR-2"},
            first(changed_header([](RawHeader& h) { h.version = 2; }), 11));
  c.invalid("version-before-profile", "version and profile are 2.", {"unsupported", "R-STR-2", "R-STR-3"},
            changed_header([](RawHeader& h) { h.version = h.profile = 2; }));
  c.invalid("profile-before-flags", "profile is 2, flags are 64.", {"malformed", "R-STR-3", "R-STR-4"},
            changed_header([](RawHeader& h) {
              h.profile = 2;
              h.flags = 64;
            }));
  c.invalid("profile-1-before-flags", "profile is 1, flags are 64.", {"unsupported", "R-STR-3", "R-STR-4"},
            changed_header([](RawHeader& h) {
              h.profile = 1;
              h.flags = 64;
            }));
  c.invalid("flags-before-size", "flags are 64, and the body is too large.", {"malformed", "R-STR-4", "R-STR-14"},
            first(changed_header([](RawHeader& h) { h.flags = 64; }), 8) + Bytes{0x01, 0x00, 0x10, 0x00});
  c.invalid("magic-before-cut", "Five bytes, the first of which is not the magic's.", {"malformed", "R-STR-1", "R-STR-5"},
            first(changed_header([](RawHeader& h) { h.magic[0] = 0x88; }), 5));
  c.invalid("crc-before-body", "tick_rate is 0, and the check value is wrong.", {"checksum", "R-STR-15", "R-STR-6"},
            with_last_bit_flipped(changed_header([](RawHeader& h) { h.tick_rate = 0; })));
  const RawHeader short_body;
  c.invalid("crc-before-cut", "The body ends before baseline_span, and the check value is wrong.",
            {"checksum", "R-STR-15", "R-STR-5"}, with_last_bit_flipped(short_body.around(first(short_body.body(), 10))));
  RawHeader still;
  still.tick_rate = 0;
  c.invalid("cut-before-rate", "tick_rate is 0; the body ends before object_count.", {"truncated", "R-STR-5", "R-STR-6"},
            still.around(first(still.body(), 11)));
  c.invalid("extrapolation-before-span", "max_extrapolation and baseline_span are 0.", {"invalid", "R-STR-8", "R-STR-9"},
            changed_header([](RawHeader& h) {
              h.max_extrapolation = 0;
              h.baseline_span = 0;
            }));
  c.invalid("span-before-count", "baseline_span is 0, object_count 4097.", {"invalid", "R-STR-9", "R-STR-14"},
            changed_header([](RawHeader& h) {
              h.baseline_span = 0;
              h.object_count = varint(4097);
            }));
}

void add_body(Catalogue& c) {
  c.invalid("rate-before-grid", "tick_rate is 0, position_exp 31.", {"invalid", "R-STR-6", "R-STR-7"},
            changed_header([](RawHeader& h) {
              h.tick_rate = 0;
              h.grid.position = 31;
            }));
  c.invalid("grid-before-extrapolation", "position_exp is 31, max_extrapolation 0.", {"invalid", "R-STR-7", "R-STR-8"},
            changed_header([](RawHeader& h) {
              h.grid.position = 31;
              h.max_extrapolation = 0;
            }));
  c.invalid("rate-before-count", "tick_rate is 0, object_count 4097.", {"invalid", "R-STR-6", "R-STR-14"},
            changed_header([](RawHeader& h) {
              h.tick_rate = 0;
              h.object_count = varint(4097);
            }));
  c.invalid("name-before-dof", "A name with a line feed, and dof 64.", {"invalid", "R-STR-11", "R-STR-12"},
            changed_header([](RawHeader& h) {
              h.objects[0] = {"a\nb", 64};
            }));
  c.invalid("dof-before-rotation", "dof 64, and a rotation of length 0.", {"invalid", "R-STR-12", "R-STR-13"},
            changed_header([](RawHeader& h) {
              h.objects[0] = {"a", 64, {}, {}};
            }));
  RawHeader cut;
  cut.objects[0].name = "a name\nof more";
  c.invalid("cut-before-name", "A name with a line feed; the body ends inside the rotation.",
            {"truncated", "R-STR-5", "R-STR-11"}, cut.around(without_last(cut.body(), 8)));
  c.invalid("extension-before-equal-names", "Two objects of one name, then an extension without a size.",
            {"malformed", "R-STR-16", "R-STR-11"}, changed_header([](RawHeader& h) {
              h.objects.push_back(h.objects[0]);
              h.extensions = {5};
            }));
  c.invalid("dof-before-equal-names", "Two objects of one name; the second one's dof is 64.", {"invalid", "R-STR-12", "R-STR-11"},
            changed_header([](RawHeader& h) {
              h.objects.push_back(h.objects[0]);
              h.objects[1].dof = 64;
            }));
}

void add_objects(Catalogue& c) {
  c.invalid("room-before-kind", "object_count is 2 where a byte is missing for two; the first one's kind is 0.",
            {"truncated", "R-STR-5", "R-STR-10"}, changed_header([](RawHeader& h) {
              h.objects[0] = {.name = "a", .kind = 0};
              h.object_count = Bytes{2};
              h.extensions = Bytes(31, 0);
            }));
  RawHeader long_name;
  long_name.objects[0] = {.name = "ten bytes!", .kind = 2};
  c.invalid("kind-before-cut", "An object of kind 2; the body ends inside its rotation.", {"unsupported", "R-STR-10", "R-STR-5"},
            long_name.around(without_last(long_name.body(), 8)));
  RawHeader second;
  second.objects = {{.name = "a name that takes the room of another object"}, {.name = "", .kind = 2}};
  c.invalid("kind-before-end", "The body ends after the kind of the second object, which is 2.",
            {"unsupported", "R-STR-10", "R-STR-5"}, second.around(without_last(second.body(), 30)));
  c.invalid("rotation-before-next-kind", "An object's rotation has length 0, the next one's kind is 2.",
            {"invalid", "R-STR-13", "R-STR-10"}, changed_header([](RawHeader& h) {
              h.objects = {{.name = "a", .rotation = {}}, {.name = "b", .kind = 2}};
            }));
  c.invalid("objects-before-deformables", "An object's dof is 64, and deformable_count 0.", {"invalid", "R-STR-12", "R-DEF-1"},
            changed_header([](RawHeader& h) {
              h.objects[0].dof = 64;
              h.flags = 1;
              h.deformables = {0};
            }));
}

}  // namespace

void add_scene_orders(Catalogue& c) {
  add_frame(c);
  add_body(c);
  add_objects(c);
}

}  // namespace tactus::conformance
