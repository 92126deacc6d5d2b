// SPDX-License-Identifier: Apache-2.0
/// Scene declarations, the headers of streams.
#include <limits>
#include <utility>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

Bytes with_name(std::string name) {
  return changed_header([&](RawHeader& h) {
    h.objects[0].name = std::move(name);
    h.extensions = {0, 0};  // room for an object of the smallest size even when the name is empty
  });
}

Bytes with_grid(const GridExponents& grid) {
  return changed_header([&](RawHeader& h) { h.grid = grid; });
}

Bytes with_rotation(const Quat30& rotation) {
  return changed_header([&](RawHeader& h) { h.objects[0].rotation = rotation; });
}

RawHeader every_dof() {
  RawHeader header;
  header.objects.clear();
  for (const unsigned turn : {0u, 8u, 16u, 32u, 56u}) {
    for (unsigned axes = 0; axes < 8; ++axes) {
      header.objects.push_back({"dof " + std::to_string(turn + axes), static_cast<std::uint8_t>(turn + axes)});
    }
  }
  return header;
}

RawHeader many_objects() {
  RawHeader header;
  header.objects.clear();
  for (int i = 0; i < 300; ++i)
    header.objects.push_back({std::to_string(i), i % 7 == 0 ? Dof::none : Dof::translation, {i, -i, i * i}});
  return header;
}

RawHeader extended() {
  RawHeader header;
  const auto extension = [&](std::uint64_t type, const Bytes& data) {
    header.extensions = header.extensions + varint(type) + varint(data.size()) + data;
  };
  extension(0, {});
  extension(1, {0xff});
  extension(300, Bytes(200, 0xaa));
  extension(std::numeric_limits<std::uint64_t>::max(), {1, 2, 3});
  return header;
}

void add_valid_headers(Catalogue& c) {
  RawHeader none;
  none.objects.clear();
  c.section(section::kDeclaration);
  c.valid("no-objects", "A scene without objects, and nothing after it.", none.bytes());
  c.valid("one-object", "A scene with one free object.", RawHeader{}.bytes());
  RawHeader low;
  low.tick_rate = 1;
  low.grid = {8, 0, 8, 0};
  low.max_extrapolation = 1;
  c.valid("lower-limits", "Every element at its lower limit.", low.bytes(), {"R-STR-6", "R-STR-7", "R-STR-8", "R-STR-9"});
  RawHeader high;
  high.tick_rate = 1000000;
  high.grid = {30, 30, 28, 20};
  high.max_extrapolation = 65535;
  high.baseline_span = 64;
  high.objects[0].position = {std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max(), -1};
  c.valid("upper-limits", "Every element at its upper limit.", high.bytes(), {"R-STR-6", "R-STR-7", "R-STR-8", "R-STR-9"});
  c.valid("widest-grid-steps", "Position and velocity, rotation and angular velocity twelve binary orders apart.",
          with_grid({30, 18, 28, 16}), {"R-STR-7"});
  RawHeader names;
  names.objects = {{"a"},
                   {std::string(255, 'n')},
                   {"quote \\\" and back\\\\slash"},
                   {"\xc2\x80 \xdf\xbf \xe0\xa0\x80 \xed\x9f\xbf \xee\x80\x80 \xef\xbf\xbf"},
                   {"\xf0\x90\x80\x80 \xf4\x8f\xbf\xbf"},
                   {"A"}};
  c.valid("names", "Names of 1 and 255 bytes, with quote and backslash, and the first and last code point of every UTF-8 length.",
          names.bytes(), {"R-STR-11"});
  c.valid("every-dof", "Every permitted set of degrees of freedom.", every_dof().bytes(), {"R-STR-12"});
  c.valid("many-objects", "300 objects: a count of two bytes.", many_objects().bytes(), {"R-STR-5"});
  c.valid("short-rotation", "A rotation as short as permitted.", with_rotation({kOne30 - 1024, 0, 0, 0}), {"R-STR-13"});
  c.valid("long-rotation", "A rotation as long as permitted.", with_rotation({kOne30, 0, 1482910, 0}), {"R-STR-13"});
  c.valid("equal-exponents", "Grids of position and velocity, of rotation and angular velocity are the same.",
          changed_header([](RawHeader& h) {
            h.grid = {20, 20, 12, 12};
          }),
          {"R-STR-7"});
  constexpr std::int32_t kUnit = 1 << 20;
  c.valid("shortest-rotation", "The squares of a rotation add to exactly 2^60 - 2^41.", changed_header([](RawHeader& h) {
            h.objects[0].rotation = {1023 * kUnit, -45 * kUnit, 4 * kUnit, 2 * kUnit};
          }),
          {"R-STR-13"});
  c.valid("longest-rotation", "The squares of a rotation add to exactly 2^60 + 2^41.", changed_header([](RawHeader& h) {
            h.objects[0].rotation = {kOne30, 0, kUnit, -kUnit};
          }),
          {"R-STR-13"});
  c.valid("extensions", "Extension records of unknown types, one empty, are skipped.", extended().bytes(), {"R-STR-16"});
}

void add_frame_faults(Catalogue& c) {
  const Bytes good = RawHeader{}.bytes();
  const Rejection cut{"truncated", "R-STR-5"};
  c.invalid("empty", "No bytes at all.", {"truncated", "R-STR-1"}, Bytes{});
  c.invalid("cut-magic", "Three bytes of the magic.", {"truncated", "R-STR-1"}, first(good, 3));
  c.invalid("wrong-magic", "The fourth byte is not the magic's.", {"malformed", "R-STR-1"},
            changed_header([](RawHeader& h) { h.magic[3] = 'U'; }));
  c.invalid("magic-alone", "The magic, and nothing after it.", cut, first(good, 4));
  c.invalid("wrong-first-byte", "The first byte is not the magic's.", {"malformed", "R-STR-1"},
            changed_header([](RawHeader& h) { h.magic[0] = 0x88; }));
  c.invalid("cut-fixed-part", "Eleven bytes: body_size is cut.", cut, first(good, 11));
  c.invalid("version-0", "version is 0.", {"unsupported", "R-STR-2"}, changed_header([](RawHeader& h) { h.version = 0; }));
  c.invalid("version-2", "version is 2.", {"unsupported", "R-STR-2"}, changed_header([](RawHeader& h) { h.version = 2; }));
  c.invalid("profile-2", "profile is 2.", {"malformed", "R-STR-3"}, changed_header([](RawHeader& h) { h.profile = 2; }));
  c.invalid("profile-1", "profile is 1: reserved.", {"unsupported", "R-STR-3"},
            changed_header([](RawHeader& h) { h.profile = 1; }));
  c.invalid("flags-64", "The seventh flag is set.", {"malformed", "R-STR-4"}, changed_header([](RawHeader& h) { h.flags = 64; }));
  c.invalid("flags", "The highest flag is set.", {"malformed", "R-STR-4"},
            changed_header([](RawHeader& h) { h.flags = 0x8000; }));
  c.invalid("huge-body", "body_size is one over the limit of 2^20; no body follows.", {"limit_exceeded", "R-STR-14"},
            first(good, 8) + Bytes{0x01, 0x00, 0x10, 0x00});
  c.invalid("largest-body-cut", "body_size is 2^20, as large as a decoder must take; no body follows.", cut,
            first(good, 8) + Bytes{0x00, 0x00, 0x10, 0x00});
  c.invalid("cut-body", "The file ends inside the body.", cut, first(good, 20));
  c.invalid("cut-crc", "The last byte of the check value is missing.", cut, without_last(good, 1));
  c.invalid("wrong-crc", "One bit of the check value is wrong.", {"checksum", "R-STR-15"}, with_last_bit_flipped(good));
}

void add_parameter_faults(Catalogue& c) {
  const RawHeader header;
  const Rejection cut{"truncated", "R-STR-5"};
  c.invalid("short-parameters", "The body ends before object_count.", cut, header.around(first(header.body(), 11)));
  c.invalid("overlong-count", "object_count 1 is written in two bytes.", {"malformed", "R-STR-5"},
            changed_header([](RawHeader& h) {
              h.object_count = Bytes{0x81, 0x00};
            }));
  c.invalid("count-over-64-bits", "object_count has ten bytes and a value of 2^64.", {"malformed", "R-STR-5"},
            changed_header([](RawHeader& h) { h.object_count = Bytes(9, 0x80) + Bytes{0x02}; }));
  for (const std::uint32_t rate : {0u, 1000001u}) {
    c.invalid("tick-rate-" + std::to_string(rate), "tick_rate is outside its range.", {"invalid", "R-STR-6"},
              changed_header([&](RawHeader& h) { h.tick_rate = rate; }));
  }
  const Rejection grid{"invalid", "R-STR-7"};
  c.invalid("position-exp-7", "position_exp is too small.", grid, with_grid({7, 7, 19, 12}));
  c.invalid("position-exp-31", "position_exp is too large.", grid, with_grid({31, 30, 19, 12}));
  c.invalid("velocity-finer", "velocity_exp is above position_exp.", grid, with_grid({20, 21, 19, 12}));
  c.invalid("velocity-coarser", "velocity_exp is 13 below position_exp.", grid, with_grid({22, 9, 19, 12}));
  c.invalid("rotation-exp-7", "rotation_exp is too small.", grid, with_grid({22, 17, 7, 7}));
  c.invalid("rotation-exp-29", "rotation_exp is too large.", grid, with_grid({22, 17, 29, 20}));
  c.invalid("angular-exp-21", "angular_exp is too large.", grid, with_grid({22, 17, 22, 21}));
  c.invalid("angular-finer", "angular_exp is above rotation_exp.", grid, with_grid({22, 17, 12, 13}));
  c.invalid("angular-coarser", "angular_exp is 13 below rotation_exp.", grid, with_grid({22, 17, 20, 7}));
  c.invalid("no-extrapolation", "max_extrapolation is 0.", {"invalid", "R-STR-8"},
            changed_header([](RawHeader& h) { h.max_extrapolation = 0; }));
  for (const std::uint8_t span : {std::uint8_t{0}, std::uint8_t{65}}) {
    c.invalid("baseline-span-" + std::to_string(span), "baseline_span is outside its range.", {"invalid", "R-STR-9"},
              changed_header([&](RawHeader& h) { h.baseline_span = span; }));
  }
  c.invalid("too-many-objects", "object_count is 4097, one over the limit.", {"limit_exceeded", "R-STR-14"},
            changed_header([](RawHeader& h) { h.object_count = varint(4097); }));
  c.invalid("4096-objects-without-room", "object_count is 4096, as many as a decoder must take; the body has room for one.", cut,
            changed_header([](RawHeader& h) { h.object_count = varint(4096); }));
  c.invalid("no-room", "object_count is 2; the body has room for one object.", cut,
            changed_header([](RawHeader& h) { h.object_count = varint(2); }));
}

void add_object_faults(Catalogue& c) {
  for (const std::uint8_t kind : {std::uint8_t{0}, std::uint8_t{2}}) {
    c.invalid("kind-" + std::to_string(kind), "The object's kind is not known.", {"unsupported", "R-STR-10"},
              changed_header([&](RawHeader& h) { h.objects[0].kind = kind; }));
  }
  RawHeader long_name;
  long_name.objects[0].name = std::string(10, 'n');
  c.invalid("cut-object", "A name of ten bytes leaves too few bytes for the rotation.", {"truncated", "R-STR-5"},
            long_name.around(without_last(long_name.body(), 8)));
  const Rejection name{"invalid", "R-STR-11"};
  c.invalid("empty-name", "A name without a byte.", name, with_name(""));
  c.invalid("control-in-name", "A line feed in a name.", name, with_name("a\nb"));
  c.invalid("delete-in-name", "Code point 127 in a name.", name, with_name("a\x7f"));
  for (const char last : {'\x1f', '\0'}) {
    c.invalid(last == 0 ? "name-with-0" : "name-with-31", "A name with a code point below 32.", {"invalid", "R-STR-11"},
              changed_header([&](RawHeader& h) { h.objects[0].name = std::string("ab") + last; }));
  }
  c.invalid("lone-continuation", "UTF-8: a continuation byte without a lead.", name, with_name("\x80"));
  c.invalid("overlong-utf8", "UTF-8: U+002F in two bytes.", name, with_name("\xc0\xaf"));
  c.invalid("overlong-utf8-3", "UTF-8: U+07FF in three bytes.", name, with_name("\xe0\x9f\xbf"));
  c.invalid("surrogate-in-name", "UTF-8: U+D800.", name, with_name("\xed\xa0\x80"));
  c.invalid("beyond-unicode", "UTF-8: U+110000.", name, with_name("\xf4\x90\x80\x80"));
  c.invalid("cut-utf8", "UTF-8: the last byte of a character is missing.", name, with_name("a\xe2\x82"));
  RawHeader twins;
  twins.objects = {{"left"}, {"right"}, {"left"}};
  c.invalid("equal-names", "The first and the last object have the same name.", name, twins.bytes());
  for (const auto& [dof, what] : {std::pair{std::uint8_t{64}, "Bit 6 of dof is set."},
                                  {std::uint8_t{128}, "Bit 7 of dof is set."},
                                  {std::uint8_t{24}, "Rotation about x and y only."},
                                  {std::uint8_t{40}, "Rotation about x and z only."},
                                  {std::uint8_t{48}, "Rotation about y and z only."}}) {
    c.invalid("dof-" + std::to_string(dof), what, {"invalid", "R-STR-12"},
              changed_header([dof = dof](RawHeader& h) { h.objects[0].dof = dof; }));
  }
  const Rejection rotation{"invalid", "R-STR-13"};
  c.invalid("rotation-component", "A component of the rotation is 2^30 + 1; the length is within the tolerance.", rotation,
            with_rotation({0, kOne30 + 1, 0, 0}));
  c.invalid("rotation-too-short", "The squares of the rotation add to just less than 2^60 - 2^41.", rotation,
            with_rotation({0, 0, -(kOne30 - 1025), 0}));
  c.invalid("rotation-too-long", "The squares of the rotation add to just more than 2^60 + 2^41.", rotation,
            with_rotation({kOne30, 0, 0, -1482911}));
}

void add_extension_faults(Catalogue& c) {
  const Rejection broken{"malformed", "R-STR-16"};
  const auto with = [](Bytes bytes) { return changed_header([&](RawHeader& h) { h.extensions = std::move(bytes); }); };
  c.invalid("extension-without-size", "The body ends after an extension's type.", broken, with({5}));
  c.invalid("extension-of-2-64", "An extension record announces 2^64 - 1 bytes.", {"malformed", "R-STR-16"},
            changed_header([](RawHeader& h) { h.extensions = Bytes{5} + varint(~std::uint64_t{0}); }));
  c.invalid("extension-too-long", "An extension's size is one more than what is left.", broken, with({5, 3, 1, 2}));
  c.invalid("extension-overlong-type", "An extension's type 5 is written in two bytes.", broken, with({0x85, 0x00, 0x00}));
  c.invalid("extension-overlong-size", "An extension's size 0 is written in two bytes.", broken, with({0x05, 0x80, 0x00}));
}

}  // namespace

void add_scene(Catalogue& catalogue) {
  add_valid_headers(catalogue);
  add_frame_faults(catalogue);
  add_parameter_faults(catalogue);
  add_object_faults(catalogue);
  add_extension_faults(catalogue);
}

}  // namespace tactus::conformance
