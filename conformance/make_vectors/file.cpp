// SPDX-License-Identifier: Apache-2.0
/// Stream files.
#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

RawHeader slider() {
  RawHeader header;
  header.objects = {{"slider", Dof::x}};
  return header;
}

Update moved(std::int32_t by) { return {0, Reason::visual, 0, {{{by, 0, 0}}}}; }

/// Three packets, the first and the last of them key.
Stream three_packets() {
  Stream stream(slider());
  stream.add({.tick = 10, .updates = {moved(100)}, .key = true});
  stream.add({.tick = 20, .updates = {moved(-7)}});
  stream.add({.tick = 5000, .updates = {moved(93)}, .key = true});
  return stream;
}

/// One packet of a free object.
Bytes one_packet() { return Stream(RawHeader{}).add({.tick = 1, .key = true}).bytes(); }

/// The three packets, then records of any kind.
template <class Extend>
Bytes extended(Extend extend) {
  Stream stream = three_packets();
  extend(stream);
  return stream.bytes();
}

Bytes between_extensions() {
  Stream stream(slider());
  stream.add_record(128, {});
  stream.add({.tick = 3, .updates = {moved(5)}, .key = true});
  stream.add_record(255, Bytes(300, 0x55));
  stream.add({.tick = 4, .updates = {moved(1)}});
  stream.add_record(200, {1, 2, 3});
  return stream.finish().bytes();
}

void add_valid_files(Catalogue& c) {
  c.section(section::kFile);
  c.valid("three-packets", "Packets, index and trailer: a complete file.", extended([](Stream& s) { s.finish(); }));
  c.valid("no-index", "The file ends after a packet: readable, not complete.", three_packets().bytes(), {"R-FIL-2"});
  c.valid("no-trailer", "The file ends after the index: readable, not complete.",
          without_last(extended([](Stream& s) { s.finish(); }), 14), {"R-FIL-2"});
  c.valid("empty-index", "No packets, an index without entries.", Stream(slider()).finish().bytes());
  c.valid("wrong-index", "An index of nonsense gives the same packets.",
          extended([](Stream& s) { s.add_record(2, Bytes(20, 0xff)).add_record(3, Bytes(8, 0xff)); }));
  c.valid("file-extensions", "Extension records before, between and after packets are skipped.", between_extensions(),
          {"R-FIL-3"});
  Stream late(slider());
  late.add({.tick = 4294967294, .updates = {moved(1)}, .key = true});
  c.valid("last-tick", "A packet at tick 2^32 - 2, the last there is.", late.finish().bytes(), {"R-FIL-6", "R-RIG-1"});
}

void add_record_faults(Catalogue& c) {
  const Bytes good = three_packets().bytes();
  const Rejection cut{"truncated", "R-FIL-2"};
  c.invalid("cut-in-packet", "The file ends inside a packet.", cut, without_last(good, 5));
  c.invalid("cut-in-record-crc", "The last byte of a record's check value is missing.", cut, without_last(good, 1));
  c.invalid("cut-after-type", "The file ends after a record's type.", cut, good + Bytes{1});
  c.invalid("cut-in-size", "The file ends inside a record's size.", cut, good + Bytes{1, 0x80});
  for (const std::uint8_t type : {std::uint8_t{0}, std::uint8_t{4}, std::uint8_t{127}}) {
    c.invalid("record-type-" + std::to_string(type), "A record of unknown type that may not be skipped.",
              {"unsupported", "R-FIL-3"}, extended([&](Stream& s) { s.add_record(type, {0}); }));
  }
  c.invalid("huge-packet", "A packet record announces 2^20 + 7 bytes; none follows.", {"limit_exceeded", "R-FIL-4"},
            good + Bytes{1} + varint((1u << 20) + 7));
  c.invalid("huge-extension", "An extension record announces 2^63 bytes; none follows.", cut,
            good + Bytes{128} + varint(std::uint64_t{1} << 63));
  c.invalid("largest-record-cut", "A packet record announces 2^20 + 6 bytes, as many as there may be; none follows.", cut,
            one_packet() + Bytes{1} + varint((1u << 20) + 6));
  c.invalid("extension-record-of-2-64", "An extension record announces 2^64 - 1 bytes; three follow.", cut,
            one_packet() + Bytes{128} + varint(~std::uint64_t{0}) + Bytes{1, 2, 3});
  c.invalid("wrong-record-crc", "One bit of a record's check value is wrong.", {"checksum", "R-FIL-5"},
            with_last_bit_flipped(good));
  c.invalid("wrong-extension-crc", "The check value of a record that is skipped is wrong.", {"checksum", "R-FIL-5"},
            with_last_bit_flipped(good + record(128, {1, 2, 3})));
}

void add_tick_faults(Catalogue& c) {
  const Bytes good = three_packets().bytes();
  const Rejection malformed{"malformed", "R-FIL-6"};
  c.invalid("overlong-size", "A record's size 2 is written in two bytes.", malformed, good + with_crc({128, 0x82, 0x00, 1, 2}));
  c.invalid("size-of-ten-bytes", "A record's size has ten bytes, none of them the last; the file ends.", malformed,
            good + Bytes{128} + Bytes(10, 0x80));
  c.invalid("size-over-64-bits", "A record's size has eleven bytes.", malformed, good + Bytes{128} + Bytes(10, 0x80) + Bytes{1});
  c.invalid("no-tick-delta", "A packet record without a byte.", malformed, good + record(1, {}));
  c.invalid("cut-tick-delta", "A packet record ends inside tick_delta.", malformed, good + record(1, {0x80}));
  c.invalid("overlong-tick-delta", "tick_delta 1 is written in two bytes.", malformed, good + record(1, Bytes{0x81, 0x00, 3, 0}));
  c.invalid("record-tick-too-late", "A record's tick is 2^32 - 1.", malformed,
            good + record(1, varint(4294967295u - 5000) + Bytes{3, 0}));
  c.invalid("trailer-of-seven-bytes", "A trailer's payload is a byte short.", malformed, good + record(3, Bytes(7, 0)));
  c.invalid("trailer-of-nine-bytes", "A trailer's payload is a byte long.", malformed, one_packet() + record(3, Bytes(9, 0)));
  c.invalid("tick-delta-of-2-64", "A second record's tick_delta is 2^64 - 1.", malformed,
            one_packet() + record(1, varint(~std::uint64_t{0}) + Bytes{1, 0}));
  Stream stream = three_packets();
  const Bytes packet = stream.packet({.tick = 5001, .updates = {moved(1)}});
  c.invalid("tick-mismatch", "The record says tick 5002, the packet 5001.", {"invalid", "R-FIL-7"},
            stream.add_packet(5002, packet).bytes());
  const Rejection after{"malformed", "R-FIL-8"};
  c.invalid("byte-after-trailer", "One byte follows the trailer.", after, extended([](Stream& s) { s.finish(); }) + Bytes{0});
  c.invalid("packet-after-trailer", "A whole packet record follows the trailer.", after,
            extended([](Stream& s) { s.finish().add({.tick = 5001, .updates = {moved(1)}}); }));
}

/// Two faults at once: the one that is read first counts.
void add_orders(Catalogue& c) {
  const Bytes good = one_packet();
  c.invalid("size-before-type", "A record of unknown type 4 with an overlong size.", {"malformed", "R-FIL-6", "R-FIL-3"},
            good + Bytes{4, 0x81, 0x00, 0});
  c.invalid("crc-before-tick-delta", "An overlong tick_delta, and a wrong check value.", {"checksum", "R-FIL-5", "R-FIL-6"},
            good + with_last_bit_flipped(record(1, Bytes{0x81, 0x00, 3, 0})));
  c.invalid("cut-before-type", "The file ends after a record's type, which is 4.", {"truncated", "R-FIL-2", "R-FIL-3"},
            good + Bytes{4});
  c.invalid("type-before-payload", "A record of unknown type 4 announces 5 bytes; none follows.",
            {"unsupported", "R-FIL-3", "R-FIL-2"}, good + Bytes{4, 5});
  c.invalid("trailer-size-before-payload", "A trailer announces 9 bytes; none follows.", {"malformed", "R-FIL-6", "R-FIL-2"},
            good + Bytes{3, 9});
}

}  // namespace

void add_file(Catalogue& catalogue) {
  add_valid_files(catalogue);
  add_record_faults(catalogue);
  add_tick_faults(catalogue);
  add_orders(catalogue);
}

}  // namespace tactus::conformance
