// SPDX-License-Identifier: Apache-2.0
/// Packets of profile main in haptic and visual layers.
#include <bit>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

RawDeformable layered_object(Shape shape, std::size_t modes, std::uint64_t seed) {
  return with_modes({.shape = std::move(shape), .frame_period = 512, .layered = 1}, modes, seed);
}

/// Steps of one stream that share what is random.
class Layers {
 public:
  Layers(const RawDeformable& item, std::uint64_t seed)
      : random_(seed),
        triangles_(static_cast<std::uint32_t>(item.shape.triangles.size())),
        modes_(item.mode_steps.size()),
        sets_(static_cast<std::uint32_t>(std::popcount(item.weight_sets))) {}

  MainStep haptic(const PacketPlace& at) {
    triangle_ = random_.below(triangles_);
    level_ = random_.below(40);
    return {.at = at,
            .layer = Layer::haptic,
            .triangle = triangle_,
            .haptic = level_,
            .visual = 200,
            .weight_set = any_set(),
            .residuals = random_residuals(random_, 5, 160)};
  }
  /// The other layer of the frame that haptic() began last.
  MainStep visual_of_same_frame(const PacketPlace& at) {
    MainStep step = visual(at, triangle_);
    step.same_frame = true;
    step.haptic = level_;
    return step;
  }
  MainStep visual(const PacketPlace& at, std::optional<std::uint32_t> triangle = {}) {
    MainStep step{.at = at,
                  .layer = Layer::visual,
                  .triangle = triangle,
                  .haptic = random_.below(40),
                  .visual = 200,
                  .density = random_.below(4),
                  .weight_set = any_set(),
                  .residuals = random_residuals(random_, 5, 60)};
    for (std::size_t k = 0; k < modes_; ++k) step.coefficients.push_back(random_.integer(5));
    return step;
  }
  std::uint32_t any_triangle() { return random_.below(triangles_); }

 private:
  std::uint32_t any_set() { return sets_ > 1 ? random_.below(sets_) : 0; }

  Random random_;
  std::uint32_t triangles_, triangle_ = 0, level_ = 0;
  std::size_t modes_;
  std::uint32_t sets_;
};

/// Both layers, either alone, neither; key packets of both kinds.
Bytes walk(const RawDeformable& item, std::uint64_t seed, int ticks) {
  DeformableStream stream(only(item));
  Layers layers(item, seed);
  for (std::int64_t i = 0; i < ticks; ++i) {
    const std::int64_t tick = 2 * i + i / 5;
    const bool key = i % 12 == 0;
    const PacketPlace at{.tick = tick, .key = key};
    switch (i % 6) {
      case 0:
      case 1:
        stream.add(layers.haptic(at));
        stream.add(layers.visual_of_same_frame({.tick = tick}));
        break;
      case 2:
        stream.add(layers.haptic(at));
        break;
      case 3:
        stream.add(layers.visual(at, layers.any_triangle()));
        break;
      case 4:
        stream.add(layers.visual({.tick = tick, .key = i % 12 == 4}));
      default:
        break;
    }
  }
  return stream.finished();
}

void add_valid(Catalogue& c) {
  c.section(section::kLayers);
  c.valid("layers", "Haptic and visual layers of one frame, either alone, touched and not, key packets of both kinds.",
          walk(layered_object(sheet(6, 5), 0, 690), 690, 40));
  c.valid("layers-basis", "The same with a basis: haptic layers leave motion alone, visual layers the area of interest.",
          walk(layered_object(sheet(5, 4), 6, 691), 691, 60));
  RawDeformable wide = layered_object(sheet(4, 3), 2, 692);
  wide.rings = 32;
  c.valid("layers-area-of-all", "All vertices are in the area of interest: a visual layer codes none.", walk(wide, 692, 24));

  const RawDeformable points = layered_object({sheet(2, 2).rest, {}}, 2, 693);
  DeformableStream untouched(only(points));
  Layers of_points(points, 693);
  for (std::int64_t i = 0; i < 8; ++i) {
    MainStep step = of_points.visual({.tick = i / 2, .key = i == 0});
    step.same_frame = i % 2 == 1;
    untouched.add(step);
  }
  c.valid("layers-without-triangles", "Without a triangle there are visual layers only, and no bit that says so.",
          untouched.finished());

  const RawDeformable item = layered_object(sheet(5, 4), 4, 694);
  Layers layers(item, 694);
  DeformableStream losses(only(item, 3));
  std::uint32_t back = 1;
  for (std::int64_t i = 0; i < 18; ++i) {
    losses.add(layers.haptic({.tick = 2 * i, .key = i == 0, .baseline = back}));
    const MainStep rest = layers.visual_of_same_frame({.tick = 2 * i});
    back = i % 3 == 1 ? 2 : 1;
    if (back == 2) losses.lose(rest);
    else losses.add(rest);
  }
  c.valid("layers-lost-visual", "Every third visual layer is lost: the next haptic layer builds on the one before it.",
          losses.finished());

  DeformableStream dropped(only(item, 3));
  dropped.add(layers.haptic({.key = true}));
  for (std::int64_t i = 1; i < 9; ++i) {
    dropped.lose(layers.haptic({.tick = 3 * i}));
    dropped.add(layers.visual({.tick = 3 * i, .baseline = 2}, layers.any_triangle()));
  }
  c.valid("layers-lost-haptic", "Haptic layers are lost: visual layers build on the state before them and have a head.",
          dropped.finished());

  DeformableStream twice(only(item, 4));
  twice.add(layers.haptic({.tick = 7, .key = true}));
  twice.add(layers.visual_of_same_frame({.tick = 7}));
  twice.add(layers.visual_of_same_frame({.tick = 7, .baseline = 2}));
  twice.add(layers.visual_of_same_frame({.tick = 7}));
  c.valid("layers-same-frame-twice", "Three visual layers of one frame: two on the haptic layer, one on a visual layer.",
          twice.finished());

  DeformableStream shown(only(item));
  for (const std::int64_t tick : {0ll, 2ll, 4ll, 5ll, 9ll, 30ll}) {
    shown.add(layers.haptic({.tick = tick, .key = tick == 0}));
    if (tick != 4) shown.add(layers.visual_of_same_frame({.tick = tick}));
  }
  c.valid("layers-shown", "What a client shows after either layer: frames count from the last visual layer.", shown.finished(),
          {}, "linear");
}

/// A key packet at tick 10, then a haptic layer at tick 30 and its visual layer.
DeformableStream three_packets(std::uint8_t span = 1) {
  const RawDeformable item = layered_object({sheet(2, 2).rest, {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}}}, 2, 695);
  DeformableStream stream(only(item, span));
  Layers layers(item, 695);
  stream.add(layers.haptic({.tick = 10, .key = true}));
  stream.add(layers.haptic({.tick = 30}));
  stream.add(layers.visual_of_same_frame({.tick = 30}));
  return stream;
}

/// The three packets, then a haptic layer at tick 32 whose symbols after `late` are written by `code`.
template <class Code>
Bytes then_haptic(Code code) {
  return three_packets()
      .add_packet(30, coded_main_packet(3,
                                        [&](RangeEncoder& coder, MainModels& models) {
                                          coder.bit(models.key, 0);
                                          coder.bit(models.layer, 0);
                                          coder.signed_value(models.late, 0);
                                          code(coder, models);
                                        }))
      .bytes();
}

void add_invalid(Catalogue& c) {
  c.invalid("layers-before-its-tick",
            "A visual layer of the same frame as an older baseline, at tick 10, after tick 30; the record cannot say so.",
            {"invalid", "R-DEF-8"},
            three_packets(4)
                .add_packet(30, coded_main_packet(3,
                                                  [](RangeEncoder& coder, MainModels& models) {
                                                    coder.bit(models.key, 0);
                                                    coder.magnitude(models.baseline, 3);
                                                    coder.bit(models.layer, 1);
                                                    coder.bit(models.same_frame, 1);
                                                  }))
                .bytes());
  c.invalid("layers-lost-baseline", "A visual layer of the same frame as a haptic layer that is missing.", {"state", "R-PKT-4"},
            three_packets()
                .add_packet(30, coded_main_packet(4,
                                                  [](RangeEncoder& coder, MainModels& models) {
                                                    coder.bit(models.key, 0);
                                                    coder.bit(models.layer, 1);
                                                    coder.bit(models.same_frame, 1);
                                                  }))
                .bytes());
  c.invalid("layers-triangle-3", "A haptic layer touches triangle 3 of 3.", {"invalid", "R-DEF-9"},
            then_haptic([](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.same_triangle, 0);
              coder.bit(models.near_triangle, 0);
              coder.raw(2, 3);
              coder.signed_value(models.haptic, 0);
              coder.bit(models.same_visual, 1);
            }));
  c.invalid("layers-haptic-169", "haptic is 169 in a haptic layer.", {"invalid", "R-DEF-10"},
            then_haptic([](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.same_triangle, 1);
              coder.signed_value(models.haptic, 169);
              coder.bit(models.same_visual, 1);
            }));
  c.invalid("layers-coefficients-in-haptic", "A haptic layer goes on after its last vertex.", {"malformed", "R-RNG-2"},
            then_haptic([](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.same_triangle, 1);
              coder.signed_value(models.haptic, 0);
              coder.bit(models.same_visual, 1);
              for (int i = 0; i < 40; ++i) coder.raw(16, 0xbeef);
            }));
}

}  // namespace

void add_deformable_layers(Catalogue& c) {
  add_valid(c);
  add_invalid(c);
}

void add_deformable_layers_fade(Catalogue& c) {
  RawDeformable faded = layered_object(sheet(5, 4), 6, 698);
  faded.fade = 3277;
  faded.weight_sets = 3;
  c.section(section::kLayers);
  c.valid("layers-fade", "Haptic layers fade nothing, visual layers nothing of what they do not code.", walk(faded, 698, 60));
}

}  // namespace tactus::conformance
