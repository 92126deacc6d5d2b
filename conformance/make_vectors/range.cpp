// SPDX-License-Identifier: Apache-2.0
/// Payloads.
#include <algorithm>
#include <limits>

#include <tactus/receiver.h>
#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();

RawHeader one(std::uint8_t dof) {
  RawHeader header;
  header.objects = {{"object", dof}};
  return header;
}

/// A file of one key packet at tick 0 or what `tick` says.
Bytes file_of(const RawHeader& header, const Bytes& packet, std::int64_t tick = 0) {
  return Stream(header).add_packet(tick, packet, true).bytes();
}

Bytes empty_payload() {
  Stream stream(one(Dof::x));
  stream.add({.tick = 7, .updates = {{0, Reason::visual, 0, {{{40, 0, 0}, {3, 0, 0}}}}}, .key = true});
  stream.add_packet(7, {1, 0});
  stream.add_packet(7, {2, 0});
  return stream.finish().bytes();
}

Bytes unsigned_widths() {
  Stream stream(one(Dof::x));
  stream.add({.tick = 0, .key = true});
  for (unsigned width = 1; width <= 32; ++width) {
    const std::int64_t low = std::int64_t{1} << (width - 1);
    stream.add({.tick = low, .key = true});
    stream.add({.tick = std::min<std::int64_t>(2 * low - 1, 4294967294), .key = true});
  }
  return stream.finish().bytes();
}

Bytes signed_widths() {
  Stream stream(one(Dof::translation));
  std::int64_t tick = 0;
  for (unsigned width = 0; width <= 31; ++width) {
    const auto high = static_cast<std::int32_t>((std::int64_t{1} << width) - 1);
    const std::int32_t low = width == 0 ? 0 : 1 << (width - 1);
    stream.add({.tick = tick++, .updates = {{0, Reason::visual, 0, {{{high, -high, low}, {-low, high, -high}}}}}, .key = true});
    stream.add({.tick = tick++, .updates = {{0, Reason::request, 0, {{{-low, 0, high}, {low, 0, 0}}}}}, .key = true});
  }
  return stream.finish().bytes();
}

Bytes many_bits_per_model() {
  RawHeader header;
  header.objects.clear();
  for (int i = 0; i < 64; ++i) header.objects.push_back({"o" + std::to_string(i), Dof::all});
  Stream stream(header);
  Random random(301);
  for (std::int64_t tick = 0; tick < 8; ++tick) {
    Step step{.tick = tick, .updates = {}, .key = tick % 4 == 0};
    for (std::uint32_t i = 0; i < 64; ++i) step.updates.push_back(random_update(random, stream.header(), i));
    stream.add(step);
  }
  return stream.finish().bytes();
}

/// A key packet whose payload holds `count` bytes of `fill` behind `lead` random ones. Any payload decodes to some symbols, so one
/// that keeps every rule is soon found; a run of zeros in the middle is what a long carry leaves behind.
Bytes payload_with_run(std::uint64_t seed, std::size_t lead, std::size_t count, std::uint8_t fill, std::size_t tail) {
  const RawHeader header = one(Dof::translation);
  Random random(seed);
  for (;;) {
    Bytes packet{1, 0};
    for (std::size_t i = 0; i < lead; ++i) packet.push_back(random.byte());
    packet.insert(packet.end(), count, fill);
    for (std::size_t i = 0; i < tail; ++i) packet.push_back(random.byte());
    auto receiver = Receiver::create(header.parsed()).value();
    if (const auto decoded = receiver.push(packet); decoded && decoded->key) return file_of(header, packet, decoded->tick);
  }
}

/// Widths found by search.
Bytes least_range() {
  const Update update{0, Reason::request, 0, {{{1 << 21, 1 << 24, 2}, {1 << 12, 1 << 9, 1 << 23}}}};
  return Stream(one(Dof::translation)).add({.tick = 0, .updates = {update}, .key = true}).bytes();
}

void add_valid_payloads(Catalogue& c) {
  c.section(section::kSymbols);
  c.valid("empty-payload", "Packets of two bytes: an empty payload is a payload of zeros.", empty_payload(),
          {"R-RNG-3", "R-PKT-2"});
  c.valid("unsigned-widths", "tick_delta of every width from 0 to 32 bits, smallest and largest value.", unsigned_widths(),
          {"R-RNG-4"});
  c.valid("signed-widths", "Residuals of every width from 0 to 31 bits, both signs.", signed_widths(), {"R-RNG-4"});
  c.valid("slow-models", "Packets of 64 objects: models reach their slowest adaptation.", many_bits_per_model());
  c.valid("carry-4", "Four zero bytes inside a payload: a carry ran through them.", payload_with_run(302, 5, 4, 0x00, 3));
  c.valid("carry-8", "Eight zero bytes inside a payload.", payload_with_run(303, 5, 8, 0x00, 3));
  c.valid("ones-4", "Four bytes ff inside a payload: no carry ran through them.", payload_with_run(304, 5, 4, 0xff, 3));
  c.valid("ones-8", "Eight bytes ff inside a payload.", payload_with_run(305, 5, 8, 0xff, 3));
  c.valid("implied-zeros", "Three bytes of payload; everything after them is read as zeros.", payload_with_run(306, 3, 0, 0, 0));
  c.valid("first-byte-255", "Three bytes of payload, the first ff.", payload_with_run(307, 0, 1, 0xff, 2));
  c.valid("least-range", "The final range is 2^24, which takes no further byte.", least_range());
}

/// The key packet that the faults below start from, padded with zeros to as many bytes as its decoder takes.
Bytes padded_packet(const RawHeader& header) {
  const Bytes packet = Stream(header).packet({.updates = {{0, Reason::visual, 1, {{{1000, 0, 0}, {-20, 0, 0}}}}}, .key = true});
  const SharedScene scene = header.parsed();
  RangeDecoder coder(std::span<const std::uint8_t>(packet).subspan(2));
  RigidModels models = start_models();
  RigidHead head;
  CodedUpdate update;
  code_head(coder, models, *scene, head);
  code_update(coder, models, *scene, 0, update);
  return packet + Bytes(coder.position() - (packet.size() - 2), 0);
}

/// A key packet whose coding `write` goes on after the key bit.
template <class Write>
Bytes after_key(const RawHeader& header, Write write) {
  return file_of(header, coded_packet(0, [&](RangeEncoder& coder, RigidModels& models) {
                   coder.bit(models.key, 1);
                   write(coder, models);
                 }));
}

void write_too_wide(RangeEncoder& coder, MagnitudeModel& model, std::uint32_t width) {
  coder.tree<4>(model, 15);
  coder.raw(5, width - 15);
}

void add_range_faults(Catalogue& c) {
  const RawHeader slider = one(Dof::x);
  const Bytes padded = padded_packet(slider);
  c.invalid("all-ones", "A payload of four bytes ff: every bit is 1, so tick_delta is too wide.", {"malformed", "R-RNG-4"},
            file_of(slider, Bytes{0, 0, 0xff, 0xff, 0xff, 0xff}));
  c.invalid("byte-left-over", "One byte more than the decoder takes.", {"malformed", "R-RNG-2"},
            file_of(slider, padded + Bytes{1}));
  c.invalid("zero-left-over", "One byte more than the decoder takes, and it is 0.", {"malformed", "R-RNG-2", "R-RNG-3"},
            file_of(slider, padded + Bytes{0}));
  c.invalid("zero-at-end", "The payload's last byte is 0.", {"malformed", "R-RNG-3"}, file_of(slider, padded));
  const Rejection wide{"malformed", "R-RNG-4"};
  const auto head_only = [](unsigned width) {
    return [width](RangeEncoder& coder, RigidModels& models) { write_too_wide(coder, models.tick_delta, width); };
  };
  c.invalid("tick-delta-33-bits", "tick_delta has 33 bits.", wide, after_key(slider, head_only(33)));
  c.invalid("tick-delta-46-bits", "tick_delta has 46 bits, the widest that can be written.", wide,
            after_key(slider, head_only(46)));
  RawHeader pair;
  pair.objects = {{"a", Dof::x}, {"b", Dof::x}};
  c.invalid("count-33-bits", "count has 33 bits.", wide, after_key(pair, [](RangeEncoder& coder, RigidModels& models) {
              coder.magnitude(models.tick_delta, 0);
              write_too_wide(coder, models.count, 33);
            }));
  c.invalid("gap-33-bits", "gap has 33 bits.", wide, after_key(pair, [](RangeEncoder& coder, RigidModels& models) {
              coder.magnitude(models.tick_delta, 0);
              coder.magnitude(models.count, 1);
              write_too_wide(coder, models.gap, 33);
            }));
  RawHeader chain = slider;
  chain.baseline_span = 4;
  c.invalid("baseline-delta-33-bits", "baseline_delta has 33 bits.", wide,
            file_of(chain, coded_packet(0, [](RangeEncoder& coder, RigidModels& models) {
                      coder.bit(models.key, 0);
                      write_too_wide(coder, models.baseline, 33);
                    })));
  const auto residual = [](std::uint32_t size) {
    return [size](RangeEncoder& coder, RigidModels& models) {
      coder.magnitude(models.tick_delta, 0);
      coder.tree<2>(models.reason, 2);
      coder.tree<4>(models.level, 0);
      coder.magnitude(models.residual[0].pose[2], size);
      coder.raw(1, 0);
    };
  };
  c.invalid("residual-2-31", "A residual of 2^31: signed values have at most 31 bits.", wide,
            after_key(slider, residual(std::uint32_t{1} << 31)));
  c.invalid("residual-2-32", "A residual of 2^32 - 1.", wide, after_key(slider, residual(0xffffffffu)));
  Stream stream(slider);
  stream.add({.tick = 3, .updates = {{0, Reason::visual, 0, {{{kLargest, 0, 0}}}}}, .key = true});
  c.invalid("second-packet", "The first packet is good, the second has a byte left over.", {"malformed", "R-RNG-2"},
            stream.add_packet(3, Bytes{1, 0} + Bytes(40, 0) + Bytes{1}).bytes());
}

}  // namespace

void add_range(Catalogue& catalogue) {
  add_valid_payloads(catalogue);
  add_range_faults(catalogue);
}

}  // namespace tactus::conformance
