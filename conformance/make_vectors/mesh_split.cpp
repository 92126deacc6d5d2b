// SPDX-License-Identifier: Apache-2.0
/// Packets of profile main in haptic and visual halves: spec/60-mesh.md section 5.
#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/mesh_build.h"

namespace tactus::conformance {
namespace {

RawMesh split_mesh(Shape shape, std::size_t modes, std::uint64_t seed) {
  return with_modes({.shape = std::move(shape), .frame_period = 512, .split = 1}, modes, seed);
}

/// Steps of one stream that share what is random.
class Halves {
 public:
  Halves(const RawMesh& mesh, std::uint64_t seed)
      : random_(seed), triangles_(static_cast<std::uint32_t>(mesh.shape.triangles.size())), modes_(mesh.mode_steps.size()) {}

  MainStep haptic(const MeshPlace& at) {
    triangle_ = random_.below(triangles_);
    level_ = random_.below(40);
    return {.at = at,
            .half = Layer::haptic,
            .triangle = triangle_,
            .haptic = level_,
            .visual = 200,
            .residuals = random_residuals(random_, 5, 160)};
  }
  /// The rest of the tick that haptic() began last.
  MainStep completing(const MeshPlace& at) {
    MainStep step = visual(at, triangle_);
    step.completes = true;
    step.haptic = level_;
    return step;
  }
  MainStep visual(const MeshPlace& at, std::optional<std::uint32_t> triangle = {}) {
    MainStep step{.at = at,
                  .half = Layer::visual,
                  .triangle = triangle,
                  .haptic = random_.below(40),
                  .visual = 200,
                  .density = random_.below(4),
                  .residuals = random_residuals(random_, 5, 60)};
    for (std::size_t k = 0; k < modes_; ++k) step.coefficients.push_back(random_.integer(5));
    return step;
  }
  std::uint32_t any_triangle() { return random_.below(triangles_); }

 private:
  Random random_;
  std::uint32_t triangles_, triangle_ = 0, level_ = 0;
  std::size_t modes_;
};

/// Both halves, either alone, neither; key packets of both kinds.
Bytes walk(const RawMesh& mesh, std::uint64_t seed, int ticks) {
  MeshStream stream(only(mesh));
  Halves halves(mesh, seed);
  for (std::int64_t i = 0; i < ticks; ++i) {
    const std::int64_t tick = 2 * i + i / 5;
    const bool key = i % 12 == 0;
    const MeshPlace at{.tick = tick, .key = key};
    switch (i % 6) {
      case 0:
      case 1:
        stream.add(halves.haptic(at));
        stream.add(halves.completing({.tick = tick}));
        break;
      case 2:
        stream.add(halves.haptic(at));
        break;
      case 3:
        stream.add(halves.visual(at, halves.any_triangle()));
        break;
      case 4:
        stream.add(halves.visual({.tick = tick, .key = i % 12 == 4}));
      default:
        break;
    }
  }
  return stream.finished();
}

void add_valid(Catalogue& c) {
  c.valid("split", "Haptic and visual halves of one tick, either alone, touched and not, key packets of both kinds.",
          walk(split_mesh(sheet(6, 5), 0, 690), 690, 40));
  c.valid("split-basis", "The same with a basis: haptic halves leave motion alone, visual halves the area of interest.",
          walk(split_mesh(sheet(5, 4), 6, 691), 691, 60));
  RawMesh wide = split_mesh(sheet(4, 3), 2, 692);
  wide.rings = 32;
  c.valid("split-area-of-all", "All vertices are in the area of interest: a visual half codes none.", walk(wide, 692, 24));

  const RawMesh points = split_mesh({sheet(2, 2).rest, {}}, 2, 693);
  MeshStream untouched(only(points));
  Halves of_points(points, 693);
  for (std::int64_t i = 0; i < 8; ++i) {
    MainStep step = of_points.visual({.tick = i / 2, .key = i == 0});
    step.completes = i % 2 == 1;
    untouched.add(step);
  }
  c.valid("split-without-triangles", "Without a triangle there are visual halves only, and no bit that says so.",
          untouched.finished());

  const RawMesh mesh = split_mesh(sheet(5, 4), 4, 694);
  Halves halves(mesh, 694);
  MeshStream losses(only(mesh, 3));
  std::uint32_t back = 1;
  for (std::int64_t i = 0; i < 18; ++i) {
    losses.add(halves.haptic({.tick = 2 * i, .key = i == 0, .baseline = back}));
    const MainStep rest = halves.completing({.tick = 2 * i});
    back = i % 3 == 1 ? 2 : 1;
    if (back == 2) losses.lose(rest);
    else losses.add(rest);
  }
  c.valid("split-lost-visual-halves", "Every third visual half is lost: the next haptic half builds on the one before it.",
          losses.finished());

  MeshStream dropped(only(mesh, 3));
  dropped.add(halves.haptic({.key = true}));
  for (std::int64_t i = 1; i < 9; ++i) {
    dropped.lose(halves.haptic({.tick = 3 * i}));
    dropped.add(halves.visual({.tick = 3 * i, .baseline = 2}, halves.any_triangle()));
  }
  c.valid("split-lost-haptic-halves", "Haptic halves are lost: visual halves build on the state before them and have a head.",
          dropped.finished());

  MeshStream twice(only(mesh, 4));
  twice.add(halves.haptic({.tick = 7, .key = true}));
  twice.add(halves.completing({.tick = 7}));
  twice.add(halves.completing({.tick = 7, .baseline = 2}));
  twice.add(halves.completing({.tick = 7}));
  c.valid("split-completed-twice", "Three visual halves of one tick: two on the haptic half, one on a visual half.",
          twice.finished());

  MeshStream shown(only(mesh));
  for (const std::int64_t tick : {0ll, 2ll, 4ll, 5ll, 9ll, 30ll}) {
    shown.add(halves.haptic({.tick = tick, .key = tick == 0}));
    if (tick != 4) shown.add(halves.completing({.tick = tick}));
  }
  c.valid("split-shown", "What a client shows after either half: frames count from the last visual half.", shown.finished(), {},
          "linear");
}

/// A key packet at tick 10, then a haptic half at tick 30 and its visual half.
MeshStream three_packets(std::uint8_t span = 1) {
  const RawMesh mesh = split_mesh({sheet(2, 2).rest, {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}}}, 2, 695);
  MeshStream stream(only(mesh, span));
  Halves halves(mesh, 695);
  stream.add(halves.haptic({.tick = 10, .key = true}));
  stream.add(halves.haptic({.tick = 30}));
  stream.add(halves.completing({.tick = 30}));
  return stream;
}

/// The three packets, then a haptic half at tick 32 whose symbols after `late` are written by `code`.
template <class Code>
Bytes then_haptic(Code code) {
  return three_packets()
      .add_packet(30, coded_main_packet(3,
                                        [&](RangeEncoder& coder, MainModels& models) {
                                          coder.bit(models.key, 0);
                                          coder.bit(models.half, 0);
                                          coder.signed_value(models.late, 0);
                                          code(coder, models);
                                        }))
      .bytes();
}

void add_invalid(Catalogue& c) {
  c.invalid("split-before-its-tick",
            "A visual half completes an older baseline at tick 10, after tick 30; the record cannot say so.",
            {"invalid", "R-MES-8"},
            three_packets(4)
                .add_packet(30, coded_main_packet(3,
                                                  [](RangeEncoder& coder, MainModels& models) {
                                                    coder.bit(models.key, 0);
                                                    coder.magnitude(models.baseline, 3);
                                                    coder.bit(models.half, 1);
                                                    coder.bit(models.completes, 1);
                                                  }))
                .bytes());
  c.invalid("split-lost-baseline", "A visual half completes a haptic half that is missing.", {"state", "R-PKT-4"},
            three_packets()
                .add_packet(30, coded_main_packet(4,
                                                  [](RangeEncoder& coder, MainModels& models) {
                                                    coder.bit(models.key, 0);
                                                    coder.bit(models.half, 1);
                                                    coder.bit(models.completes, 1);
                                                  }))
                .bytes());
  c.invalid("split-triangle-3", "A haptic half touches triangle 3 of 3.", {"invalid", "R-MES-9"},
            then_haptic([](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.same_triangle, 0);
              coder.bit(models.near_triangle, 0);
              coder.raw(2, 3);
              coder.signed_value(models.haptic, 0);
              coder.bit(models.same_visual, 1);
            }));
  c.invalid("split-haptic-169", "haptic is 169 in a haptic half.", {"invalid", "R-MES-10"},
            then_haptic([](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.same_triangle, 1);
              coder.signed_value(models.haptic, 169);
              coder.bit(models.same_visual, 1);
            }));
  c.invalid("split-coefficients-in-haptic-half", "A haptic half goes on after its last vertex.", {"malformed", "R-RNG-2"},
            then_haptic([](RangeEncoder& coder, MainModels& models) {
              coder.bit(models.same_triangle, 1);
              coder.signed_value(models.haptic, 0);
              coder.bit(models.same_visual, 1);
              for (int i = 0; i < 40; ++i) coder.raw(16, 0xbeef);
            }));
}

}  // namespace

void add_mesh_split(Catalogue& c) {
  add_valid(c);
  add_invalid(c);
}

}  // namespace tactus::conformance
