// SPDX-License-Identifier: Apache-2.0
/// Loads: their declaration, their packets, and every rule of them.
#include <tactus/load/load_syntax.h>

#include <limits>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();
constexpr std::uint16_t kHasLoads = 2;

RawHeader with_loads(RawHeader header, std::uint8_t force_exp, std::uint8_t users) {
  header.flags |= kHasLoads;
  header.loads = {force_exp, users};
  return header;
}

RawHeader one(std::uint8_t users = 1) { return with_loads({}, 10, users); }

/// Two objects that move, and a wall between them.
RawHeader two(std::uint8_t users = 1) {
  RawHeader header;
  header.objects = {{"a"}, {"wall", Dof::none}, {"b", Dof::x}};
  return with_loads(header, 10, users);
}

struct LoadOf {
  std::uint32_t gap = 0;
  std::uint8_t level = 0;
  std::vector<LoadStep> steps{};  ///< those that are left out have not changed
};

LoadStep to(std::int32_t x, std::int32_t y, std::int32_t z) { return {true, {x, y, z}}; }

/// A packet with any values in its head and its gaps; in scenes of several substreams behind `substream`.
Bytes load_packet(const Scene& scene, std::uint16_t sequence, LoadHead head, const std::vector<LoadOf>& objects) {
  return with_payload(sequence, [&](RangeEncoder& coder) {
    LoadModels models;
    code_head(coder, models, scene, head);
    for (const LoadOf& object : objects) {
      if (scene.moving().size() > 1) coder.magnitude(models.gap, object.gap);
      std::vector<LoadStep> steps = object.steps;
      steps.resize(vectors_of_load(scene));
      std::uint8_t level = object.level;
      code_load(coder, models, level, steps);
    }
  });
}

/// Packets of loads in substream 1, one after the other.
class LoadStream {
 public:
  explicit LoadStream(const RawHeader& header)
      : stream_(header), number_(static_cast<std::uint8_t>(1 + stream_.header().deformables.size())) {}

  LoadStream& add(std::int64_t tick, const std::vector<LoadOf>& objects, bool key = false, std::uint32_t baseline = 1) {
    const std::int64_t base = key ? 0 : ticks_[ticks_.size() - baseline];
    const LoadHead head{{key, baseline, static_cast<std::uint32_t>(tick - base)}, static_cast<std::uint32_t>(objects.size())};
    return add_packet(tick, load_packet(stream_.header(), static_cast<std::uint16_t>(ticks_.size()), head, objects), key);
  }
  LoadStream& add_packet(std::int64_t tick, const Bytes& packet, bool key = false) {
    stream_.add_packet(tick, Bytes{number_} + packet, key);
    ticks_.push_back(tick);
    return *this;
  }
  /// A packet of the rigid objects.
  LoadStream& add_rigid(const Step& step) {
    stream_.add_packet(step.tick, Bytes{0} + stream_.packet(step), step.key);
    return *this;
  }
  Bytes finished() { return stream_.finish().bytes(); }
  const Bytes& bytes() const { return stream_.bytes(); }
  const Scene& scene() const { return stream_.header(); }
  std::uint16_t next() const { return static_cast<std::uint16_t>(ticks_.size()); }

 private:
  Stream stream_;
  std::uint8_t number_;
  std::vector<std::int64_t> ticks_;
};

Bytes pushed_cube() {
  LoadStream stream(one());
  Random random(450);
  for (std::int64_t i = 0; i < 12; ++i) {
    if (i % 3 == 0) stream.add_rigid({.tick = 10 * i, .updates = {random_update(random, stream.scene(), 0)}, .key = i == 0});
    const auto any = [&] { return LoadStep{random.below(3) > 0, {random.integer(12), random.integer(12), random.integer(12)}}; };
    stream.add(10 * i, {{0, static_cast<std::uint8_t>(i % 8), {any(), any(), any()}}}, i % 5 == 0);
  }
  return stream.finished();
}

Bytes others_fall_back() {
  RawHeader header = two(2);
  header.baseline_span = 4;
  LoadStream stream(header);
  stream.add(5, {{0, 0, {to(100, -200, 300), to(0, 0, 7), to(1, 2, 3), to(-4, -5, -6)}}, {0, 0, {to(9, 9, 9)}}}, true);
  stream.add(6, {{1, 0, {to(1, 0, 0)}}});
  stream.add(7, {{0, 0, {{}, to(0, 0, 1)}}}, false, 2);  // b is as after the first packet
  stream.add(9, {{0, 0, {}}}, false, 3);                 // nothing has changed: a and b as after the first
  return stream.finished();
}

Bytes many_objects() {
  RawHeader header;
  header.objects.clear();
  for (int i = 0; i < 40; ++i) header.objects.push_back({std::to_string(i), i % 3 == 0 ? Dof::none : Dof::x});
  LoadStream stream(with_loads(header, 0, 0));
  stream.add(0, {{0, 0, {to(1, 1, 1)}}, {24, 0, {{}, to(2, 0, 0)}}}, true);
  stream.add(1, {{25, 0, {to(3, 0, 0)}}});
  return stream.finished();
}

Bytes saturated() {
  LoadStream stream(with_loads({}, 20, 64));
  std::vector<LoadStep> all(66, to(kLargest, -kLargest, 1));
  stream.add(0, {{0, 0, all}}, true);
  stream.add(1, {{0, 0, all}});
  stream.add(2, {{0, 7, all}});
  stream.add(3, {{0, 7, std::vector<LoadStep>(66, to(-kLargest, kLargest, -1))}});
  return stream.finished();
}

Bytes beside_a_deformable() {
  RawHeader header = with_deformables({}, {RawDeformable{.shape = sheet(3, 3), .name = "sheet"}});
  header = with_loads(header, 12, 1);
  header.extensions = varint(7) + varint(2) + Bytes{1, 2};
  LoadStream stream(header);
  stream.add(4, {{0, 2, {to(1, 2, 3), to(4, 5, 6), to(7, 8, 9)}}}, true);
  stream.add(8, {{0, 1, {to(-1, 0, 0), {}, to(0, 31, 32)}}});
  return stream.finished();
}

Bytes promised() {
  RawHeader header = one();
  const auto f64 = [](double v) {
    const auto bits = std::bit_cast<std::uint64_t>(v);
    Bytes out;
    for (unsigned i = 0; i < 8; ++i) out.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
    return out;
  };
  const Bytes bounds = f64(1) + f64(0.006) + f64(0.03) + Bytes{0} + f64(0.1) + f64(0.5);
  header.extensions = varint(2) + varint(bounds.size()) + bounds;
  return header.bytes();
}

void add_declarations(Catalogue& c) {
  const Rejection wrong{"invalid", "R-STR-19"}, cut{"truncated", "R-STR-5"};
  c.valid("declaration-limits", "force_exp 0 and no user; nothing follows.", with_loads({}, 0, 0).bytes(), {"R-STR-19"});
  c.valid("bounds", "A bounds record with those of loads.", promised(), {"R-STR-17"});
  c.invalid("force-exp-21", "force_exp is 21.", wrong, with_loads({}, 21, 1).bytes());
  c.invalid("users-65", "Forces of 65 users.", wrong, with_loads({}, 10, 65).bytes());
  RawHeader still;
  still.objects = {{"wall", Dof::none}};
  c.invalid("nothing-moves", "Loads where no object moves.", wrong, with_loads(still, 10, 1).bytes());
  RawHeader without;
  without.flags = kHasLoads;
  c.invalid("no-declaration", "The flag is set and the body ends.", cut, without.bytes());
  without.loads = {10};
  c.invalid("half-a-declaration", "The body ends before load_users.", cut, without.bytes());
  RawHeader bounds = one();
  bounds.extensions = varint(2) + varint(25) + Bytes(25, 0);
  c.invalid("bounds-cut", "A bounds record without those of loads.", {"truncated", "R-STR-17"}, bounds.bytes());
}

/// Rigid objects with the largest loads, and 226 deformable ones whose states are large.
Bytes near_the_limit(int objects) {
  RawHeader header;
  header.objects.clear();
  for (int i = 0; i < objects; ++i) header.objects.push_back({"r" + std::to_string(i)});
  header.baseline_span = 64;
  return with_loads(with_deformables(header, with_large_states(226)), 10, 64).bytes();
}

LoadStream two_packets() {
  LoadStream stream(two());
  stream.add(10, {{0, 0, {to(4, 0, 0)}}}, true);
  stream.add(30, {{1, 0, {to(5, 0, 0)}}});
  return stream;
}

/// The two packets, then a third with any head.
Bytes then(const LoadHead& head, const std::vector<LoadOf>& objects) {
  LoadStream stream = two_packets();
  return stream.add_packet(30, load_packet(stream.scene(), stream.next(), head, objects)).bytes();
}

void add_rules(Catalogue& c) {
  const Rejection tick{"invalid", "R-LOD-1"}, count{"invalid", "R-LOD-2"}, object{"invalid", "R-LOD-3"};
  c.invalid("tick-over-limit", "A key packet at tick 2^32 - 1; no record can say so.", tick,
            then({{true, 1, 0xffffffffu}, 1}, {{}}));
  RawHeader spanned = two();
  spanned.baseline_span = 4;
  LoadStream past(spanned);
  past.add(10, {{0, 0, {to(4, 0, 0)}}}, true).add(30, {{0, 0, {to(1, 0, 0)}}});
  c.invalid("baseline-in-the-past", "A packet on an older baseline, at tick 29, after tick 30; the record cannot say so.", tick,
            past.add_packet(30, load_packet(past.scene(), 2, {{false, 2, 19}, 1}, {{}})).bytes());
  c.invalid("count-0", "A packet that names no object.", count, then({{false, 1, 0}, 0}, {}));
  c.invalid("count-3", "count is 3; two objects move.", count, then({{false, 1, 0}, 3}, {}));
  c.invalid("first-gap-beyond", "The first gap goes past the last moving object.", object,
            then({{false, 1, 0}, 1}, {{2, 0, {}}}));
  c.invalid("gap-wraps", "A second gap of 2^32 - 1 would lead back to the first object in 32-bit arithmetic.", object,
            then({{false, 1, 0}, 2}, {{0, 0, {}}, {0xffffffffu, 0, {}}}));
  LoadStream wide = two_packets();
  const Bytes too_wide = with_payload(wide.next(), [&](RangeEncoder& coder) {
    LoadModels models;
    LoadHead head{{false, 1, 0}, 1};
    code_head(coder, models, wide.scene(), head);
    coder.magnitude(models.gap, 0);
    coder.tree<3>(models.level, 0);
    coder.bit(models.changed[0], 1);
    coder.magnitude(models.step[0][0], 0x80000000u);
    coder.raw(1, 0);
  });
  c.invalid("step-too-wide", "The magnitude of a step is 2^31.", {"malformed", "R-RNG-4"}, wide.add_packet(30, too_wide).bytes());
  LoadStream long_one = two_packets();
  c.invalid("bytes-left-over", "Bytes follow the payload.", {"malformed", "R-RNG-2"},
            long_one.add_packet(30, load_packet(long_one.scene(), 2, {{false, 1, 0}, 1}, {{}}) + Bytes(8, 1)).bytes());
}

void add_orders(Catalogue& c) {
  c.invalid("declaration-before-name", "force_exp is 21, and two objects have the same name.",
            {"invalid", "R-STR-19", "R-STR-11"}, [] {
              RawHeader header;
              header.objects = {{"a"}, {"a"}};
              return with_loads(header, 21, 1).bytes();
            }());
  c.invalid("tick-before-count", "A tick in the past, and count 0.", {"invalid", "R-LOD-1", "R-LOD-2"},
            then({{false, 1, 0xffffffffu}, 0}, {}));
  c.section(section::kLimits);
  c.valid("states-below-limit",
          "15 objects with loads of 64 users beside objects with models: their states take 268429632 bytes.", near_the_limit(15),
          {"R-STR-18"});
  c.invalid("states-over-limit", "16 such objects: 268486128 bytes, more than 2^28.", {"limit_exceeded", "R-STR-18"},
            near_the_limit(16));
}

}  // namespace

void add_load(Catalogue& c) {
  c.section(section::kLoadPacket);
  c.valid("pushed-cube", "A cube and its load in turn, at every level.", pushed_cube(), {"R-LOD-1"});
  c.valid("others-fall-back", "Objects and vectors that a packet does not name are those of its baseline.", others_fall_back(),
          {"R-LOD-2", "R-LOD-3"});
  c.valid("many-objects", "Gaps among 26 objects that move, without users.", many_objects(), {"R-LOD-3"});
  c.valid("saturated", "64 users; every vector at both ends of its range, at the finest and the coarsest level.", saturated());
  c.valid("beside-a-deformable", "Loads are substream 2 behind a deformable object; an extension follows their declaration.",
          beside_a_deformable(), {"R-PKT-6"});
  c.valid("playout", "The first one, shown in the past.", pushed_cube(), {}, "playout");
  add_declarations(c);
  add_rules(c);
  add_orders(c);
}

}  // namespace tactus::conformance
