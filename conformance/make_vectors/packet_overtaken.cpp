// SPDX-License-Identifier: Apache-2.0
/// Packets that others have overtaken. A file's ticks never fall: all are of one tick but the first.
#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

constexpr std::int64_t kTick = 30;

/// A stream of two objects; packet `sequence` builds on the one `baseline` before it, 0: on the initial state.
class Overtaken {
 public:
  explicit Overtaken(std::uint8_t span) : stream_(header(span)) {}

  Overtaken& add(std::int32_t sequence, std::uint32_t baseline, std::int64_t tick = kTick) {
    const auto by = static_cast<std::int32_t>(sequence % 100 + 3);
    const std::uint32_t object = sequence % 2 == 0 ? 0 : 1;
    stream_.add({.tick = tick,
                 .updates = {{object, Reason::visual, 0, {{{by, -by, 0}, {2 * by, 0, 0}}}}},
                 .key = baseline == 0,
                 .baseline = baseline == 0 ? 1 : baseline,
                 .sequence = static_cast<std::uint16_t>(sequence)});
    return *this;
  }
  Bytes finished() { return stream_.finish().bytes(); }
  const Bytes& bytes() const { return stream_.bytes(); }

 private:
  static RawHeader header(std::uint8_t span) {
    RawHeader header;
    header.baseline_span = span;
    header.objects = {{"a"}, {"b", Dof::translation}};
    return header;
  }
  Stream stream_;
};

void add_rigid_packets(Catalogue& c) {
  c.section(section::kNumbers);
  c.valid("overtaken", "Packet 2 comes after 3 and names the other object; the next ones build on it.",
          Overtaken(8).add(0, 0, 10).add(1, 1).add(3, 2).add(2, 1).add(4, 2).add(5, 3).finished(), {"R-PKT-5", "R-RIG-1"});
  c.valid("overtaken-key", "A key packet that was overtaken does not restart: what was before it may be a baseline.",
          Overtaken(8).add(0, 0, 10).add(2, 2).add(1, 0).add(3, 3).add(4, 3).finished(), {"R-PKT-4"});
  c.valid("overtaken-wrap", "Packet 65535 comes after 0 and 1.",
          Overtaken(4).add(65534, 0, 10).add(65536, 2).add(65537, 1).add(65535, 1).add(65538, 3).finished(), {"R-PKT-5"});
  c.valid("overtaken-and-full", "The state after packet 2 takes the place of that after 1.",
          Overtaken(2).add(0, 0, 10).add(1, 1).add(3, 2).add(2, 1).add(4, 2).finished(), {"R-PKT-5"});
  c.invalid("overtaken-twice", "A packet that was overtaken comes again.", {"state", "R-PKT-5"},
            Overtaken(8).add(0, 0, 10).add(1, 1).add(3, 2).add(2, 1).add(2, 1).bytes());
  c.invalid("overtaken-by-all", "Packet 2 comes when the lowest state kept is that after 3.", {"state", "R-PKT-5"},
            Overtaken(2).add(0, 0, 10).add(1, 1).add(3, 2).add(4, 1).add(2, 1).bytes());
  c.invalid("overtaken-and-dropped", "Packet 4 was overtaken by 5 and 6, for which the state that it builds on had to make room.",
            {"state", "R-PKT-4"}, Overtaken(3).add(0, 0, 10).add(1, 1).add(3, 2).add(5, 2).add(6, 1).add(4, 3).bytes());
  c.invalid("overtaken-and-restarted",
            "A key packet restarts; the one before it, which was overtaken, is below the lowest state kept.",
            {"state", "R-PKT-5"}, Overtaken(8).add(0, 0, 10).add(1, 1).add(40001, 0).add(40000, 0).bytes());
  c.invalid("overtaken-in-the-future", "A packet that was overtaken has a higher tick than the one that overtook it.",
            {"invalid", "R-RIG-1"}, Overtaken(8).add(0, 0, 10).add(1, 1).add(3, 2).add(2, 1, kTick + 1).bytes());
  c.invalid("overtaken-key-in-the-future", "The same of a key packet.", {"invalid", "R-RIG-1"},
            Overtaken(8).add(0, 0, 10).add(1, 1).add(3, 2).add(2, 0, kTick + 1).bytes());
}

void add_deformable_packets(Catalogue& c) {
  const auto stream = [] {
    Random random(640);
    DeformableStream out(only({.shape = sheet(3, 2)}, 8));
    out.add(MainStep{.at = {.tick = 10, .key = true}, .residuals = random_residuals(random, 5, 200)});
    out.add(MainStep{.at = {.tick = kTick}, .residuals = random_residuals(random, 5, 200)});
    out.add(MainStep{.at = {.tick = kTick, .baseline = 2, .sequence = std::uint16_t{3}},
                     .residuals = random_residuals(random, 5, 200)});
    return out;
  };
  Random other(641);
  const auto overtaken = [&](std::int64_t tick) {
    return MainStep{.at = {.tick = tick, .sequence = std::uint16_t{2}}, .residuals = random_residuals(other, 5, 200)};
  };
  DeformableStream valid = stream();
  valid.add(overtaken(kTick));
  valid.add(MainStep{.at = {.tick = kTick + 5, .baseline = 2, .sequence = std::uint16_t{4}}});
  c.valid("overtaken-main", "Packet 2 comes after 3; the next one builds on it.", valid.finished(), {"R-PKT-5", "R-DEF-8"});
  c.invalid("overtaken-main-in-the-future", "A packet that was overtaken has a higher tick than the one that overtook it.",
            {"invalid", "R-DEF-8"}, stream().add(overtaken(kTick + 1)).bytes());
}

}  // namespace

void add_packet_overtaken(Catalogue& c) {
  add_rigid_packets(c);
  add_deformable_packets(c);
}

}  // namespace tactus::conformance
