// SPDX-License-Identifier: Apache-2.0
/// What a client shows in an eased scene.
#include <limits>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

constexpr std::uint16_t kIsEased = 4;
constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();

RawHeader eased_scene(std::vector<RawObject> objects = {{"cube"}}, std::uint8_t span = 1) {
  RawHeader header{.objects = std::move(objects)};
  header.flags = kIsEased;
  header.baseline_span = span;
  return header;
}

Update pushed(std::int32_t i, unsigned ease, unsigned keep, std::uint32_t object = 0) {
  return {object,
          Reason::haptic,
          0,
          {{{900 + i, -500, 40 * i}, {3000 - 700 * i, 20 * i, -700}, {9000, -3000 * i, 800}, {300 * i, -90, 70 * i}}},
          0,
          static_cast<std::uint8_t>(ease),
          static_cast<std::uint8_t>(keep)};
}

/// Every `ease` with every `keep`, each over before the next.
Bytes every_ease() {
  Stream stream(eased_scene());
  std::int64_t tick = 3;
  for (unsigned ease = 0; ease < 8; ++ease) {
    for (unsigned keep = 0; keep < (ease == 0 ? 1u : 4u); ++keep) {
      stream.add({.tick = tick, .updates = {pushed(static_cast<std::int32_t>(4 * ease + keep), ease, keep)}, .key = tick == 3});
      tick += (std::int64_t{1} << ease) + 2;
    }
  }
  return stream.finish().bytes();
}

/// Updates of which the next comes while they are easing; one lets nothing stay, one comes at the tick of the one before.
Bytes overlapping() {
  Stream stream(eased_scene());
  std::int32_t i = 0;
  for (const auto& [tick, ease, keep] : {std::array<unsigned, 3>{5, 5, 0},
                                         {9, 5, 1},
                                         {10, 4, 0},
                                         {17, 0, 0},
                                         {20, 6, 2},
                                         {50, 6, 0},
                                         {50, 3, 3},
                                         {57, 4, 0},
                                         {72, 4, 0},
                                         {88, 4, 0},
                                         {105, 2, 0}}) {
    stream.add({.tick = tick, .updates = {pushed(i, ease, keep)}, .key = i == 0});
    ++i;
  }
  return stream.finish().bytes();
}

/// By half a circle, by next to nothing, and from one end of the grid to the other.
Bytes far_apart() {
  Stream stream(eased_scene({{"cube", Dof::all, {-kLargest, kLargest, 0}}}));
  const auto to = [](Vec3i position, Vec3i rotation, unsigned ease, unsigned keep) {
    return std::vector<Update>{{0,
                                Reason::visual,
                                1,
                                {{position, {}, rotation, {}}},
                                0,
                                static_cast<std::uint8_t>(ease),
                                static_cast<std::uint8_t>(keep)}};
  };
  stream.add({.tick = 2, .updates = to({kLargest, -kLargest, kLargest}, {0, kHalfCircle >> 1, 0}, 4, 0), .key = true});
  stream.add({.tick = 7, .updates = to({-kLargest, kLargest, -kLargest}, {0, 0, -(kHalfCircle >> 1)}, 4, 0)});
  stream.add({.tick = 12, .updates = to({-kLargest, kLargest, -kLargest}, {1, 0, 0}, 5, 1)});
  stream.add({.tick = 50, .updates = to({}, {}, 4, 0)});
  return stream.add({.tick = 70, .updates = to({1, -1, 0}, {}, 1, 3)}).finish().bytes();
}

/// Every object is named by every third packet, every fifth packet is lost, many updates overlap.
Bytes several_objects(bool with_losses, std::uint64_t seed) {
  Stream stream(eased_scene(
      {{"a"}, {"b", Dof::x | Dof::y}, {"wall", Dof::none}, {"c", Dof::rz}, {"d", Dof::all, {1, 2, 3}, {0, kOne30, 0, 0}}}, 64));
  Random random(seed);
  std::int64_t tick = 0;
  for (std::uint32_t i = 0; i < 150; ++i) {
    Step step{.tick = tick,
              .updates = {},
              .key = i == 0,
              .baseline = with_losses && i % 5 == 4 ? 2u : 1u,
              .sequence = static_cast<std::uint16_t>(i)};
    const auto add = [&](std::uint32_t object) {
      Update update = random_update(random, stream.header(), object);
      update.ease = static_cast<std::uint8_t>(random.below(7));
      update.keep = static_cast<std::uint8_t>(update.ease > 0 ? random.below(4) : 0);
      step.updates.push_back(update);
    };
    for (const std::uint32_t object : {0u, 1u, 3u, 4u})
      if (random.below(3) == 0) add(object);
    if (step.updates.empty()) add(3);
    if (!with_losses || i % 5 != 3) stream.add(step);
    tick += random.below(30) == 0 ? 301 : random.below(25);
  }
  return stream.finish().bytes();
}

/// An update that comes between two that are known, and another sender's that begins again in the past.
Bytes out_of_order() {
  Stream stream(eased_scene({{"a"}, {"b"}}, 64));
  stream.add({.tick = 5, .updates = {pushed(0, 5, 0, 0), pushed(1, 4, 0, 1)}, .key = true});
  stream.add({.tick = 30, .updates = {pushed(6, 5, 0, 0), pushed(7, 5, 1, 1)}});
  stream.add({.tick = 45, .updates = {pushed(2, 5, 0, 0)}, .baseline = 2, .sequence = std::uint16_t{3}});
  stream.add({.tick = 45, .updates = {pushed(3, 5, 0, 0), pushed(4, 4, 1, 1)}, .baseline = 1, .sequence = std::uint16_t{2}});
  stream.add({.tick = 50, .updates = {pushed(5, 3, 0, 0), pushed(5, 3, 0, 1)}, .baseline = 1, .sequence = std::uint16_t{4}});
  return stream.add({.tick = 90, .updates = {pushed(5, 6, 0, 1)}, .baseline = 1}).finish().bytes();
}

}  // namespace

void add_client_eased(Catalogue& c) {
  const auto add = [&](const char* name, const char* what, const Bytes& bytes, const char* way) {
    c.valid(name, what, bytes, {}, way);
  };
  c.section(section::kEased);
  add("eased-every-ease", "Every ease with every keep.", every_ease(), "none");
  add("eased-overlapping", "Updates that come while others are easing.", overlapping(), "none");
  add("eased-far-apart", "Offsets of half a circle and from one end of the grid to the other.", far_apart(), "none");
  add("eased-several-objects", "150 packets of four objects.", several_objects(false, 560), "none");
  add("eased-out-of-order", "An overtaken update is not shown.", out_of_order(), "none");
  add("eased-playout", "Every ease with every keep, shown in the past.", every_ease(), "playout");
  add("eased-playout-overlapping", "What is left of one update is part of the next.", overlapping(), "playout");
  add("eased-playout-far-apart", "Far offsets, shown in the past.", far_apart(), "playout");
  add("eased-playout-losses",
      "150 packets of four objects, every fifth lost: curves over the gaps, and what is left beside them.",
      several_objects(true, 561), "playout");
  add("eased-playout-out-of-order", "An overtaken update changes what is left at the one after it.", out_of_order(), "playout");
}

}  // namespace tactus::conformance
