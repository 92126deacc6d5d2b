// SPDX-License-Identifier: Apache-2.0
/// Motion constants of a scene, and the predictors that updates choose.
#include <limits>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();
constexpr std::int32_t kMost = 1 << 28;  // of a motion constant
constexpr std::uint8_t kLinear = 0, kBallistic = 1, kSlide = 2;
constexpr Vec3i kDown{0, 0, -1285816};  // 9.81 m/s^2
constexpr std::int32_t kSlow = 20000;   // 0.15 m/s^2

RawHeader with_motion(RawHeader header, const Vec3i& gravity, std::int32_t slide) {
  header.flags |= 8;
  header.motion.clear();
  ByteWriter w(header.motion);
  for (const std::int32_t c : gravity) w.i32(c);
  w.i32(slide);
  return header;
}

RawHeader moving() { return with_motion({}, kDown, kSlow); }

/// A header of other grids and clocks.
RawHeader with_clock(const GridExponents& grid, std::uint32_t tick_rate, std::uint16_t max_extrapolation) {
  RawHeader header;
  header.grid = grid;
  header.tick_rate = tick_rate;
  header.max_extrapolation = max_extrapolation;
  return header;
}

/// An update every so many ticks, of which every third is a key packet: its baseline is the initial state.
Bytes walk(const RawHeader& header, std::uint64_t seed, int packets, std::uint32_t longest) {
  Stream stream(header);
  Random random(seed);
  std::int64_t tick = 0;
  for (int i = 0; i < packets; ++i) {
    Update update = random_update(random, stream.header(), 0);
    update.predictor = static_cast<std::uint8_t>(random.below(3));
    stream.add({.tick = tick, .updates = {update}, .key = i % 16 == 0});
    tick += random.below(longest);
  }
  return stream.finish().bytes();
}

/// The same motion again and again, each time seen `dt` ticks later.
Bytes seen_after(const RawHeader& header, std::uint8_t predictor, const std::array<Vec3i, kQuantities>& first,
                 std::initializer_list<int> dts) {
  Stream stream(header);
  std::int64_t tick = 0;
  const auto add = [&](const std::array<Vec3i, kQuantities>& residual, bool key) {
    stream.add({.tick = tick, .updates = {{0, Reason::visual, 0, residual, predictor}}, .key = key});
  };
  for (const int dt : dts) {
    add(first, true);
    tick += dt;
    add({{{}, {-700, 700, 0}, {}, {}}}, false);
  }
  return stream.finish().bytes();
}

/// Every predictor after every reason, and after every other predictor.
Bytes every_predictor() {
  Stream stream(moving());
  std::int64_t tick = 0;
  for (int i = 0; i < 36; ++i) {
    const auto predictor = static_cast<std::uint8_t>((i + i / 3) % 3);
    const Update update{
        0, static_cast<Reason>(i % 4), 0, {{{3, -2, 1}, {-900, 8000, -100}, {4, 0, -5}, {1, 100, -2}}}, predictor};
    stream.add({.tick = tick, .updates = {update}, .key = i == 0});
    tick += 7 + 3 * i;
  }
  return stream.finish().bytes();
}

Bytes two_objects() {
  RawHeader header = moving();
  header.objects = {{"a"}, {"rail", Dof::x}, {"wall", Dof::none}};
  Stream stream(header);
  const auto update = [](std::uint32_t object, std::uint8_t predictor) {
    return Update{object, Reason::visual, 1, {{{5, 0, 0}, {700, 0, 0}}}, predictor};
  };
  stream.add({.tick = 0, .updates = {update(0, kSlide), update(1, kBallistic)}, .key = true});
  stream.add({.tick = 20, .updates = {update(1, kSlide)}});
  stream.add({.tick = 45, .updates = {update(0, kLinear)}});
  stream.add({.tick = 60, .updates = {update(1, kLinear)}, .key = true});
  return stream.finish().bytes();
}

Bytes then(const RawHeader& header, const CodedUpdate& update) {
  Stream stream(header);
  stream.add({.tick = 10, .updates = {{}}, .key = true});
  return stream.add_packet(10, raw_packet(stream.header(), 1, {{false, 1, 0}, 1}, std::vector<RawUpdate>{{0, update}})).bytes();
}

CodedUpdate choosing(std::uint8_t predictor, std::int32_t turn = 0) {
  return {.reason = Reason::visual, .residual = {{{{1, 0, 0}, {}, {turn, 0, 0}, {}}}}, .predictor = predictor};
}

/// A predictor that is not there, and after it a residual of 33 bits.
Bytes too_wide_then() {
  Stream stream(moving());
  stream.add({.tick = 10, .updates = {{}}, .key = true});
  return stream
      .add_packet(10, coded_packet(1,
                                   [](RangeEncoder& coder, RigidModels& models) {
                                     coder.bit(models.key, 0);
                                     coder.magnitude(models.tick_delta, 0);
                                     coder.tree<2>(models.reason, 0);
                                     coder.tree<4>(models.level, 0);
                                     coder.tree<2>(models.predictor[0], 3);
                                     coder.tree<4>(models.residual[0].pose[0], 15);
                                     coder.raw(5, 18);
                                   }))
      .bytes();
}

void add_rules(Catalogue& c) {
  const Rejection rule{"invalid", "R-RIG-7"};
  c.invalid("predictor-3", "An update names predictor 3.", rule, then(moving(), choosing(3)));
  c.invalid("no-gravity", "An update chooses ballistic where gravity is 0.", rule,
            then(with_motion({}, {}, kSlow), choosing(kBallistic)));
  c.invalid("no-deceleration", "An update chooses slide where slide_deceleration is 0.", rule,
            then(with_motion({}, kDown, 0), choosing(kSlide)));
  c.invalid("predictor-before-length", "Predictor 3, and a rotation that is too long.", {"invalid", "R-RIG-7", "R-RIG-6"},
            then(moving(), choosing(3, kHalfCircle + 1)));
  c.invalid("residual-before-predictor", "Predictor 3, and a residual of 33 bits.", {"malformed", "R-RNG-4", "R-RIG-7"},
            too_wide_then());
}

/// Between packets 1 and 3 of these predictors, the second of which is lost.
Bytes over_a_gap(std::uint8_t predictor, const Vec3i& velocity, std::int64_t end = 45) {
  RawHeader header = moving();
  header.baseline_span = 64;
  Stream stream(header);
  stream.add({.tick = 5, .updates = {{0, Reason::visual, 0, {}}}, .key = true});
  stream.add({.tick = 5, .updates = {{0, Reason::visual, 0, {{{}, velocity, {9, 0, 0}, {0, 30, 2000}}}, predictor}}});
  stream.add({.tick = end,
              .updates = {{0, Reason::visual, 0, {{{90000, 5, 30}, {300, -9, 0}, {5000, 0, 77}, {1, 1, 300}}}, kSlide}},
              .baseline = 3,
              .sequence = std::uint16_t{3}});
  return stream.finish().bytes();
}

/// Every predictor, eased into, some of them before the one before has been.
Bytes eased_predictors() {
  RawHeader header = moving();
  header.flags |= 4;
  Stream stream(header);
  std::int64_t tick = 0;
  for (std::uint8_t i = 0; i < 48; ++i) {
    const auto ease = static_cast<std::uint8_t>(5 * i % 7);
    const auto keep = static_cast<std::uint8_t>(ease > 0 ? i % 4 : 0);
    const auto predictor = static_cast<std::uint8_t>((i + i / 3) % 3);
    stream.add({.tick = tick,
                .updates = {{0,
                             Reason::visual,
                             2,
                             {{{300, -200, 9 * i}, {-900, 8000, -100}, {40, 0, -500}, {1, 100, -2}}},
                             predictor,
                             ease,
                             keep}},
                .key = i == 0});
    tick += 3 + 7 * (i % 5);
  }
  return stream.finish().bytes();
}

}  // namespace

void add_scene_motion(Catalogue& c) {
  c.section(section::kDeclaration);
  c.valid("motion", "A scene with motion constants.", moving().bytes(), {"R-STR-4", "R-STR-22"});
  c.valid("motion-gravity", "Gravity along y, no deceleration.", with_motion({}, {0, 5, 0}, 0).bytes(), {"R-STR-22"});
  c.valid("motion-slide", "A deceleration, no gravity.", with_motion({}, {}, 1).bytes(), {"R-STR-22"});
  c.valid("motion-limits", "Motion constants at their limits.", with_motion({}, {kMost, -kMost, kMost}, kMost).bytes(),
          {"R-STR-22"});
  RawHeader loads = moving();
  loads.flags |= 2;
  loads.loads = {10, 1};
  c.valid("motion-after-loads", "Loads, then motion constants.", loads.bytes(), {"R-STR-22"});
  const Rejection rule{"invalid", "R-STR-22"};
  c.invalid("gravity-beyond", "gravity is 2^28 + 1 along x.", rule, with_motion({}, {kMost + 1, 0, 0}, 0).bytes());
  c.invalid("gravity-below", "gravity is -2^28 - 1 along z.", rule, with_motion({}, {0, 0, -kMost - 1}, 0).bytes());
  c.invalid("deceleration-beyond", "slide_deceleration is 2^28 + 1.", rule, with_motion({}, kDown, kMost + 1).bytes());
  c.invalid("deceleration-below-0", "slide_deceleration is -1.", rule, with_motion({}, kDown, -1).bytes());
  c.invalid("motion-of-nothing", "All motion constants are 0.", rule, with_motion({}, {}, 0).bytes());
  RawHeader still = moving();
  still.objects = {{"wall", Dof::none}};
  c.invalid("motion-where-nothing-moves", "Motion constants where no object moves.", rule, still.bytes());
  RawHeader cut = moving();
  cut.motion.pop_back();
  c.invalid("motion-cut", "The body ends inside slide_deceleration.", {"truncated", "R-STR-5"}, cut.bytes());
  RawHeader wrong = with_motion(loads, {}, 0);
  wrong.loads = {21, 1};
  c.invalid("loads-before-motion", "force_exp is 21, and all motion constants are 0.", {"invalid", "R-STR-19", "R-STR-22"},
            wrong.bytes());
  still.motion.pop_back();
  c.invalid("motion-cut-before-nothing-moves", "The body ends inside slide_deceleration, and no object moves.",
            {"truncated", "R-STR-5", "R-STR-22"}, still.bytes());
  RawHeader extension = with_motion({}, {}, 0);
  extension.extensions = {5};
  c.invalid("motion-before-extension", "All motion constants are 0, then an extension without a size.",
            {"invalid", "R-STR-22", "R-STR-16"}, extension.bytes());
}

void add_rigid_predictors(Catalogue& c) {
  c.section(section::kRigidPacket);
  c.valid("every-predictor", "Every predictor with every reason.", every_predictor(), {"R-RIG-7"});
  c.valid("predictors-of-two", "Two objects with predictors of their own; a key packet brings one back to the initial state.",
          two_objects());
  c.section(section::kPrediction);
  c.valid("predictors", "Updates that choose any predictor.", walk(moving(), 450, 60, 60));
  c.valid("predictors-one-axis", "The same of an object that slides along y, gravity along all axes.",
          walk(with_motion({.objects = {{"slider", Dof::y}}}, {900000, -700000, 123456}, 3000), 451, 40, 200));
  c.valid("ballistic-extrapolation", "Free fall up to, at and beyond max_extrapolation.",
          seen_after(with_motion(with_clock({22, 17, kRotationExp, 12}, 1000, 50), {-3, 700001, -1285816}, 0), kBallistic,
                     {{{1, 2, 3}, {-4000, 90, 90000}, {}, {500, 2000, -900}}}, {0, 1, 2, 49, 50, 51, 5000}));
  c.valid("ballistic-limits", "The strongest gravity for the longest time, on the widest grid steps and the slowest clock.",
          seen_after(with_motion(with_clock({30, 18, 28, 16}, 1, 65535), {kMost, -kMost, 1}, 0), kBallistic,
                     {{{}, {5, -5, kLargest}, {}, {}}}, {1, 2, 3, 40, 65535}));
  c.valid("ballistic-fast-clock", "The strongest gravity at a million ticks per second.",
          seen_after(with_motion(with_clock({22, 17, kRotationExp, 12}, 1000000, 65535), {kMost, -kMost, 7}, 0), kBallistic,
                     {{{}, {5, kLargest, 0}, {}, {}}}, {1, 2, 1000, 65535}));
  c.valid("slide-to-rest", "An object that slides, seen before it rests, as it rests, and later.",
          seen_after(with_motion({}, {}, 10000077), kSlide, {{{}, {300000, -400000, 0}, {}, {900, -30000, 5}}},
                     {0, 1, 25, 49, 50, 51, 52, 100, 3000}));
  c.valid("slide-part-of-a-tick", "Objects that rest after parts of a tick.",
          seen_after(with_motion({}, {}, kMost), kSlide, {{{}, {3, 300000, 0}, {}, {0, 70000, 0}}}, {1, 2, 3, 2000}));
  for (const std::int32_t rest : {701, 12801})  // x 2^-8 ticks
    c.valid(
        "slide-" + std::to_string(rest), "A fast rotation that ends after " + std::to_string(rest) + " / 256 ticks.",
        seen_after(with_motion({}, {}, 256000000), kSlide, {{{}, {0, -1000 * rest, 0}, {}, {0, 1 << 25, 77}}}, {1, 2, 3, 90}));
  c.valid("slide-without-velocity", "An object that only turns rests at once.",
          seen_after(with_motion({}, {}, 100000), kSlide, {{{}, {}, {}, {900, -30000, 5}}}, {0, 1, 2, 300}));
  c.valid("slide-extrapolation", "Sliding beyond max_extrapolation.",
          seen_after(with_motion(with_clock({22, 17, kRotationExp, 12}, 1000, 50), {}, 20000), kSlide,
                     {{{}, {4000, 9, -9}, {}, {500, 2000, -900}}}, {49, 50, 51, 199, 200, 201, 5000}));
  c.valid("slide-limits", "The largest velocities with the least deceleration, on the slowest clock and the widest grid steps.",
          seen_after(with_motion(with_clock({30, 18, 28, 16}, 1, 65535), {}, 1), kSlide,
                     {{{}, {kLargest, -kLargest, 1}, {}, {1 << 25, -(1 << 25), 1 << 25}}}, {1, 2, 65535}));
  c.valid("slide-far", "What constant velocities would reach in a tick is beyond 2^33; the object rests in a small part of it.",
          seen_after(with_motion(with_clock({30, 18, 28, 16}, 1, 65535), {}, kMost), kSlide,
                     {{{}, {1 << 23, -(1 << 22), 3}, {}, {1 << 25, -(1 << 25), 1 << 25}}}, {1, 2, 65535}));
  c.valid("slide-fast-clock", "A million ticks per second.",
          seen_after(with_motion(with_clock({22, 17, kRotationExp, 12}, 1000000, 65535), {}, 10000000), kSlide,
                     {{{}, {kLargest, 5, -kLargest}, {}, {70000, -3, 0}}}, {1, 2, 1000, 65535}));
  c.section(section::kMotion);
  c.valid("ballistic-saturated", "Free fall up to both ends of 32 bits of the velocity.",
          seen_after(with_motion(with_clock({22, 17, kRotationExp, 12}, 10, 65535), {kMost, -kMost, 0}, 0), kBallistic,
                     {{{}, {kLargest - 40, 40 - kLargest, 0}, {}, {}}}, {1, 2, 300}));
  c.valid("predictors-slow-clock", "Any predictor at 5 ticks per second.",
          walk(with_motion(with_clock({22, 17, kRotationExp, 12}, 5, 90), kDown, 90), 452, 40, 30));
  add_rules(c);
}

void add_client_predictors(Catalogue& c) {
  c.section(section::kShownPose);
  c.valid("predictors-none", "Updates that choose any predictor, shown at once.", walk(moving(), 660, 30, 90), {}, "none");
  c.valid("predictors-linear", "The same with linear interpolation.", walk(moving(), 660, 30, 90), {}, "linear");
  c.section(section::kPlayout);
  const auto playout = [&](const char* name, const char* what, const Bytes& file) { c.valid(name, what, file, {}, "playout"); };
  playout("playout-ballistic", "A curve that begins in free fall.", over_a_gap(kBallistic, {9000, 0, 30000}));
  playout("playout-slide", "A curve that begins sliding and would rest after 30 of 40 ticks.", over_a_gap(kSlide, {600, 0, 0}));
  playout("playout-slides-on", "A curve that begins sliding and would not rest.", over_a_gap(kSlide, {6000, -70, 0}, 60));
  c.section(section::kEased);
  c.valid("eased-predictors", "Updates with every predictor that are eased into.", eased_predictors(), {}, "none");
  c.valid("eased-predictors-playout", "The same, shown in the past.", eased_predictors(), {}, "playout");
}

}  // namespace tactus::conformance
