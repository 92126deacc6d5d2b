// SPDX-License-Identifier: Apache-2.0
/// Every row of the start models of deformable objects that a packet can use.
#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

/// A number of `width` bits of 1: in groups of raw bits the last interval, where no bit of the range is lost.
constexpr std::int32_t of_width(int width) { return (1 << width) - 1; }
constexpr int kWidths = 16;

/// Key packets at ticks of every width up to 15, and levels that fall below 0 by numbers of every width up to 15.
Bytes ticks_and_levels() {
  DeformableStream stream(only({.shape = one_triangle()}));
  for (int width = 0; width < kWidths; ++width) {
    const std::int64_t tick = std::int64_t{2} * of_width(width);
    stream.add(MainStep{
        .at = {.tick = tick, .key = true, .sequence = static_cast<std::uint16_t>(2 * width)}, .triangle = 0u, .haptic = 5});
    stream.add_packet(tick + 1,
                      coded_main_packet(static_cast<std::uint16_t>(2 * width + 1), [&](RangeEncoder& coder, MainModels& models) {
                        coder.bit(models.key, 0);
                        coder.signed_value(models.late, 0);
                        coder.bit(models.touched[1], 1);
                        coder.bit(models.same_triangle, 1);
                        coder.signed_value(models.haptic, -of_width(width));
                        coder.bit(models.same_visual, 1);
                        coder.tree<2>(models.density[1], 1);
                      }));
  }
  return stream.finished();
}

/// From the last of 64 triangles of a fan to every other one, whose place is its number.
Bytes every_near_place() {
  DeformableStream stream(only({.shape = flat_fan(64)}));
  stream.add(MainStep{.at = {.tick = 0, .key = true}, .triangle = 63u});
  std::int64_t tick = 0;
  for (std::uint32_t triangle = 0; triangle < 63; ++triangle) {
    stream.add(MainStep{.at = {.tick = ++tick}, .triangle = triangle});
    stream.add(MainStep{.at = {.tick = ++tick}, .triangle = 63u});
  }
  return stream.finished();
}

/// In every group coefficients of every width up to 15 after one of every class.
Bytes every_coefficient() {
  DeformableStream stream(only(with_modes({.shape = one_vertex()}, 28, 720)));
  std::int64_t tick = 0;
  for (int width = 0; width < kWidths; ++width) {
    for (std::int32_t before = 0; before < 3; ++before) {
      MainStep packet{.at = {.tick = tick, .key = tick == 0}};
      for (int pair = 0; pair < 14; ++pair)
        packet.coefficients.insert(packet.coefficients.end(), {before, pair % 2 == 0 ? of_width(width) : -of_width(width)});
      stream.add(packet);
      ++tick;
    }
  }
  return stream.finished();
}

/// Every density with every tightness; components of every width up to 15 after one of every class.
Bytes every_component() {
  DeformableStream stream(only({.shape = both(sheet(5, 4), moved(flat_fan(12), {0, 0, 90000})), .rings = 1}));
  Random random(721);
  std::uint32_t share = 0;
  const auto any = [&](const VertexPrediction&) {
    if (random.below(8) >= share) return Vec3i{};
    const auto first = static_cast<std::int32_t>(random.below(3));
    const std::int32_t wide = of_width(static_cast<int>(random.below(kWidths)));
    return random.below(3) == 0 ? Vec3i{-wide, 0, 0} : Vec3i{first, -wide, 0};
  };
  for (std::uint32_t i = 0; i < 180; ++i) {
    share = i % 5 == 0 ? 1 : i % 5 == 1 ? 3 : 7;
    stream.add(MainStep{.at = {.tick = i, .key = i == 0},
                        .triangle = random.below(52),
                        .haptic = i % 3 == 0   ? 38u
                                  : i % 3 == 1 ? 33u
                                               : 19u,
                        .density = i % 4,
                        .residuals = any});
  }
  return stream.finished();
}

}  // namespace

void add_deformable_start_rows(Catalogue& c) {
  c.section(section::kDeformableStartModels);
  c.valid("ticks-and-haptic-changes", "tick_delta and haptic_change of every width up to 15: all rows of their start models.",
          ticks_and_levels());
  c.valid("every-near-place", "Every place of a list of 63: all rows of its start models.", every_near_place());
  c.valid("every-coefficient", "Coefficients in every context, of every width up to 15: all rows of their start models.",
          every_coefficient());
  c.valid("every-component", "Vertices in every context, components of every width up to 15: all rows of their start models.",
          every_component());
}

}  // namespace tactus::conformance
