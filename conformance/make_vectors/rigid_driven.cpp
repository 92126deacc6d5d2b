// SPDX-License-Identifier: Apache-2.0
/// Driven objects: their constants, what updates tell of the device, and what a client shows that knows it.
#include <limits>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();
constexpr std::uint32_t kMost = 1u << 30;  // of a constant
constexpr std::uint8_t kDriven = 3;
constexpr std::int32_t kDown = -1285816;  // 9.81 m/s^2
constexpr std::int32_t kSlide = 900072;   // 0.7 of it
constexpr std::int32_t kMillimetre = 4194;

/// Of one moving object.
struct Constants {
  std::uint32_t coupling = 1075200, hold = 116053;  // 630 and 68 N/m, 0.15 kg
  std::array<std::uint32_t, 3> inertia{286331, 286331, 286331};
  std::uint16_t friction = 128, damping = 1049;
};
constexpr Constants kNone{0, 0, {0, 0, 0}, 0, 0};

RawHeader with_driven(RawHeader header, const std::vector<Constants>& all) {
  header.flags |= 16;
  header.driven.clear();
  ByteWriter w(header.driven);
  for (const Constants& c : all) {
    w.u32(c.coupling);
    w.u32(c.hold);
    for (const std::uint32_t i : c.inertia) w.u32(i);
    w.u16(c.friction);
    w.u16(c.damping);
  }
  return header;
}

RawHeader with_gravity(RawHeader header, const Vec3i& gravity = {0, 0, kDown}, std::int32_t slide = kSlide) {
  header.flags |= 8;
  ByteWriter w(header.motion);
  for (const std::int32_t c : gravity) w.i32(c);
  w.i32(slide);
  return header;
}

RawHeader one(const Constants& constants = {}) { return with_driven({}, {constants}); }

Update telling(const std::array<std::int32_t, 7>& contact, bool held = false, const Vec3i& velocity = {},
               const Vec3i& angular = {}) {
  return {.residual = {{{}, velocity, {}, angular}}, .predictor = kDriven, .is_held = held, .contact = contact};
}

/// Every predictor but ballistic and slide, which the scene does not declare, and contacts that add up.
Bytes contacts() {
  Stream stream(one());
  stream.add({.tick = 3, .updates = {telling({-160, 5, 40, -1024, 0, 0, 12}, false, {9000, 0, 0})}, .key = true});
  stream.add({.tick = 9, .updates = {telling({1, -1, 0, 0, 0, 3, -20})}});
  stream.add({.tick = 14, .updates = {Update{}}});
  stream.add({.tick = 20, .updates = {telling({3, 0, -9, 0, 0, 0, 0}, true)}});
  stream.add({.tick = 21, .updates = {telling({0, 0, 0, 700, -700, 0, 5})}});
  return stream.add({.tick = 30, .updates = {telling({7, 7, 7, 7, 7, 7, 7})}, .key = true}).finish().bytes();
}

/// Sums that are clamped, at both ends.
Bytes far_contacts() {
  Stream stream(one());
  constexpr std::int32_t kEnd = 1 << 20;
  stream.add({.tick = 1, .updates = {telling({kEnd, -kEnd, kEnd + 1, -kEnd - 1, kLargest, -kLargest, kEnd})}, .key = true});
  stream.add({.tick = 2, .updates = {telling({1, -1, -1, 1, kLargest, -kLargest, 1})}});
  return stream.add({.tick = 4, .updates = {telling({-kLargest, kLargest, 0, 0, 0, 0, -kLargest})}}).finish().bytes();
}

/// Beside an object that no device drives, with motion constants and easing.
Bytes beside_others() {
  RawHeader header = with_gravity({.objects = {{"a"}, {"rail", Dof::x}, {"wall", Dof::none}}});
  header.flags |= 4;
  Stream stream(with_driven(header, {kNone, {}}));
  Update told = telling({-160, 0, 0, -1024, 0, 0, 0}, false, {9000, 0, 0});
  told.object = 1;
  told.ease = 4;
  const Update falls{.residual = {{{5, 0, 0}, {700, 0, 0}}}, .predictor = 1};
  stream.add({.tick = 0, .updates = {falls, told}, .key = true});
  stream.add({.tick = 7, .updates = {told}});
  return stream.add({.tick = 12, .updates = {falls}}).finish().bytes();
}

/// The device is object 0, the cube object 1: 40 mm wide, in the middle, on the ground.
RawHeader touched(const Constants& constants = {}, std::uint8_t dof = Dof::all) {
  RawHeader header{.objects = {{"device"}, {"cube", dof}}};
  return with_driven(with_gravity(header), {kNone, constants});
}

Update device_at(const Vec3i& place_residual, const Vec3i& velocity_residual) {
  return {.object = 0, .residual = {{place_residual, velocity_residual}}};
}

/// From the left the device comes and pushes; it turns the cube, loses it and pushes again.
Bytes pushed(const RawHeader& header, const Vec3i& spin) {
  Stream stream(header);
  stream.add({.tick = 2, .updates = {device_at({-18 * kMillimetre, kMillimetre, 0}, {13107, 0, 0})}, .key = true});
  Update told = telling({-164, 8, 0, -1024, 0, 0, 20}, false, {6000, 300, 0}, spin);
  told.object = 1;
  stream.add({.tick = 6, .updates = {told}});
  stream.add({.tick = 40, .updates = {device_at({900, -50, 20}, {9000, -2000, 700})}});
  stream.add({.tick = 90, .updates = {device_at({-30, 0, 0}, {-60000, 0, 0})}});
  stream.add({.tick = 130, .updates = {device_at({}, {50000, 0, 0})}});
  told.contact = {0, -3, 5, 0, 100, 0, -30};
  return stream.add({.tick = 160, .updates = {told}}).add({.tick = 400, .updates = {device_at({}, {})}}).finish().bytes();
}

/// The device holds the cube, lifts it, swings it and goes away.
Bytes held(const RawHeader& header) {
  Stream stream(header);
  stream.add({.tick = 2, .updates = {device_at({0, 0, 25 * kMillimetre}, {0, 0, 13107})}, .key = true});
  Update told = telling({10, -5, 164, 0, 0, 0, 0}, true, {0, 0, 800}, {100, -200, 50});
  told.object = 1;
  stream.add({.tick = 5, .updates = {told}});
  stream.add({.tick = 60, .updates = {device_at({100, 200, 0}, {40000, -9000, 13107})}});
  told.residual = {};
  told.contact = {};
  stream.add({.tick = 200, .updates = {told}});
  stream.add({.tick = 300, .updates = {device_at({kLargest / 8, 0, 0}, {0, 0, -kLargest / 4})}});
  return stream.add({.tick = 420, .updates = {device_at({}, {})}}).finish().bytes();
}

/// No device was heard of when the update came.
Bytes before_the_device() {
  Stream stream(touched());
  Update told = telling({-164, 0, 0, -1024, 0, 0, 0}, false, {6000, 0, 0});
  told.object = 1;
  stream.add({.tick = 6, .updates = {told}, .key = true});
  stream.add({.tick = 30, .updates = {device_at({-18 * kMillimetre, 0, 0}, {})}});
  return stream.add({.tick = 60, .updates = {told}}).add({.tick = 90, .updates = {device_at({}, {})}}).finish().bytes();
}

/// Any constants, grids, contacts, velocities and places.
Bytes random_contacts(std::uint64_t seed) {
  Random random(seed);
  const auto constant = [&] { return 1 + random.below(1u << random.below(31)); };
  RawHeader header{.objects = {{"device"}, {"cube"}, {"rail", Dof::x | Dof::rz}, {"axle", Dof::rx}}};
  header.tick_rate = 1 + random.below(3000);
  header.grid.position = static_cast<std::uint8_t>(14 + random.below(17));
  header.grid.velocity = static_cast<std::uint8_t>(header.grid.position - random.below(13));
  header.grid.angular_velocity = static_cast<std::uint8_t>(8 + random.below(13));
  const unsigned near = header.grid.position - 5u;  // width of 31 mm
  header.flags |= 4;
  std::vector<Constants> all{kNone};
  for (int i = 0; i < 3; ++i)
    all.push_back({constant(),
                   constant(),
                   {constant(), constant(), constant()},
                   static_cast<std::uint16_t>(random.below(65536)),
                   static_cast<std::uint16_t>(random.below(65536))});
  const Vec3i gravity{random.integer(28), random.integer(28), random.integer(28)};
  Stream stream(with_driven(with_gravity(header, gravity, static_cast<std::int32_t>(random.below(1u << random.below(29)))), all));
  std::int64_t tick = 0;
  for (int i = 0; i < 60; ++i) {
    Step step{.tick = tick, .updates = {}, .key = i % 16 == 0};
    const Vec3i place{random.integer(near), random.integer(near), random.integer(near)};  // arguments have no order
    const Vec3i velocity{random.integer(14), random.integer(14), random.integer(14)};
    step.updates.push_back(device_at(place, velocity));
    const std::uint32_t object = 1 + random.below(3);
    Update update = random_update(random, stream.header(), object);
    update.predictor = random.below(4) == 0 ? 0 : kDriven;
    update.is_held = random.below(3) == 0;
    for (std::int32_t& c : update.contact) c = random.integer(random.below(8) == 0 ? 16 : 11);
    if (random.below(4) > 0) update.residual[0] = {object < 3 ? random.integer(near) : 0, 0, 0};
    if (update.predictor == 0) update.contact = {};
    step.updates.push_back(update);
    stream.add(step);
    tick += random.below(40);
  }
  return stream.finish().bytes();
}

/// The device stands where the last word of it was, and the cube is told to be pushed from there, time and again.
Bytes pushes(const RawHeader& header, const Vec3i& device, const std::vector<Update>& told, int ticks) {
  Stream stream(header);
  stream.add({.tick = 1, .updates = {device_at(device, {})}, .key = true});
  std::int64_t tick = 5;
  for (Update update : told) {
    update.object = 1;
    Step step{.tick = tick, .updates = {device_at({}, {}), update}, .key = true};
    step.updates[0].residual[0] = device;
    stream.add(step);
    tick += ticks;
  }
  return stream.add({.tick = tick, .updates = {device_at({}, {})}}).finish().bytes();
}

/// The least speeds that make a screw, on the finest grid.
Bytes slowest() {
  RawHeader header = touched();
  header.grid.position = 30;
  header.grid.velocity = 27;
  std::vector<Update> told;
  for (const std::int32_t speed : {511, 512, 1023, 1024, 1025, 2047, 2048})
    told.push_back(telling({-164, 0, 0, -1024, 0, 0, 0}, false, {speed, 0, 0}));
  return pushes(header, {-(18 << 20), 1 << 18, 0}, told, 12);
}

/// The device at the face, and 2^-28 m to either side.
Bytes at_the_face() {
  RawHeader header = touched();
  header.grid.position = 28;
  const Update told = telling({-164, 0, 0, -1024, 0, 0, 0}, false, {900, 0, 0});
  Stream stream(header);
  std::int64_t tick = 1;
  for (const int beyond : {-2, -1, 0, 1, 2}) {
    Update update = told;
    update.object = 1;
    stream.add({.tick = tick, .updates = {device_at({-(164 << 15) + beyond, 0, 0}, {}), update}, .key = true});
    tick += 9;
  }
  return stream.add({.tick = tick, .updates = {device_at({}, {})}}).finish().bytes();
}

/// A device 1 m off, along an axis and along two at once of a cube that is turned by 45 degrees: the proxy slides as far as it may.
Bytes far_off(const Constants& constants) {
  std::vector<Update> told;
  for (const std::int32_t turn : {0, 208567, 90000}) {
    Update update = telling({0, 0, 0, 0, 0, 1024, 9}, false, {900, 400, 0});
    update.residual[2] = {0, 0, turn};
    told.push_back(update);
  }
  return pushes(touched(constants), {(1 << 22) - 9000, 1 << 22, -50}, told, 8);
}

/// Weight and friction of the ground at their ends; the device lifts the cube.
Bytes on_the_ground(const Vec3i& gravity, std::int32_t slide, std::uint8_t velocity_exp) {
  RawHeader header{.objects = {{"device"}, {"cube"}}};
  header.grid.velocity = velocity_exp;
  header = with_driven(with_gravity(header, gravity, slide), {kNone, {}});
  const std::int32_t speed = 1 << (velocity_exp - 4);
  const std::vector<Update> told(2, telling({-164, 8, 0, -1024, 0, 300, 0}, false, {speed, speed / 3, speed / 7}));
  return pushes(header, {-18 * kMillimetre, kMillimetre, kMillimetre}, told, 15);
}

/// A tick in a second: the longest steps.
Bytes slow_clock() {
  RawHeader header = touched();
  header.tick_rate = 1;
  return pushes(header, {-18 * kMillimetre, 0, 0},
                {telling({-164, 8, 0, -1024, 0, 0, 0}, false, {kLargest, 0, 0}),
                 telling({-164, 8, 0, -1024, 0, 0, -9}, false, {300000, 0, 0}, {0, 9, 0})},
                4);
}

Bytes then(const RawHeader& header, const CodedUpdate& update) {
  Stream stream(header);
  stream.add({.tick = 10, .updates = {Update{}}, .key = true});
  return stream.add_packet(10, raw_packet(stream.header(), 1, {{false, 1, 0}, 1}, std::vector<RawUpdate>{{0, update}})).bytes();
}

RawHeader two(const Constants& first, const Constants& second) {
  return with_driven({.objects = {{"a"}, {"wall", Dof::none}, {"b"}}}, {first, second});
}

}  // namespace

void add_scene_driven(Catalogue& c) {
  c.section(section::kDeclaration);
  c.valid("driven", "A driven scene without motion constants.", one().bytes(), {"R-STR-4", "R-STR-23"});
  c.valid("driven-limits", "Constants at their limits, an object that nothing drives, and a static one.",
          two({kMost, kMost, {kMost, 1, kMost}, 65535, 65535}, kNone).bytes(), {"R-STR-23"});
  c.valid("driven-least", "The least constants.", two(kNone, {1, 0, {1, 1, 1}, 0, 0}).bytes(), {"R-STR-23"});
  c.valid("driven-after-motion", "Motion constants, then those of driven objects.", with_driven(with_gravity({}), {{}}).bytes(),
          {"R-STR-23"});
  const Rejection rule{"invalid", "R-STR-23"};
  c.invalid("driven-by-nothing", "All constants of driven objects are 0.", rule, two(kNone, kNone).bytes());
  c.invalid("coupling-beyond", "coupling is 2^30 + 1.", rule, one({.coupling = kMost + 1}).bytes());
  c.invalid("coupling-0", "coupling is 0, others are not.", rule, one({.coupling = 0}).bytes());
  c.invalid("hold-beyond", "hold is 2^30 + 1.", rule, one({.hold = kMost + 1}).bytes());
  c.invalid("inertia-beyond", "inertia is 2^30 + 1 about x.", rule, one({.inertia = {kMost + 1, 1, 1}}).bytes());
  c.invalid("inertia-0", "inertia is 0 about z.", rule, one({.inertia = {1, 1, 0}}).bytes());
  c.invalid("damping-alone", "damping is 1, and all else 0.", rule, one({0, 0, {0, 0, 0}, 0, 1}).bytes());
  c.invalid("friction-alone", "friction is 1, and all else 0.", rule, one({0, 0, {0, 0, 0}, 1, 0}).bytes());
  c.invalid("driven-where-nothing-moves", "A driven scene in which no object moves.", rule,
            with_driven({.objects = {{"wall", Dof::none}}}, {}).bytes());
  RawHeader cut = one();
  cut.driven.pop_back();
  c.invalid("driven-cut", "The body ends inside damping.", {"truncated", "R-STR-5"}, cut.bytes());
  RawHeader wrong = one({.coupling = 0});
  wrong.extensions = {5};
  c.invalid("driven-before-extension", "coupling is 0, then an extension without a size.", {"invalid", "R-STR-23", "R-STR-16"},
            wrong.bytes());
  RawHeader motion = with_driven(with_gravity({}, {}, 0), {{.coupling = 0}});
  c.invalid("motion-before-driven", "All motion constants are 0, and coupling.", {"invalid", "R-STR-22", "R-STR-23"},
            motion.bytes());
}

void add_rigid_driven(Catalogue& c) {
  c.section(section::kDriven);
  c.valid("contacts",
          "Updates that tell contacts, as differences from those of the baseline; one of another predictor between them.",
          contacts(), {"R-RIG-7"});
  c.valid("far-contacts", "Contacts at their limits and beyond.", far_contacts());
  c.valid("driven-beside-others", "A driven object beside one that falls, in an eased scene.", beside_others());
  c.valid("driven-unseen", "What a client without a device shows: constant velocities.", pushed(touched(), {0, 0, 900}), {},
          "none");
  c.valid("driven-unseen-playout", "The same in the way playout.", pushed(touched(), {0, 0, 900}), {}, "playout");
  const Rejection rule{"invalid", "R-RIG-7"};
  CodedUpdate driven{.reason = Reason::visual, .residual = {}, .predictor = kDriven};
  c.invalid("driven-by-no-device", "An update of an object whose coupling is 0 names predictor 3.", rule,
            then(with_driven({.objects = {{"a"}, {"b"}}}, {kNone, {}}), driven));
  driven.predictor = 1;
  c.invalid("ballistic-in-driven", "An update chooses ballistic in a driven scene without motion constants.", rule,
            then(one(), driven));
  driven.predictor = 2;
  c.invalid("slide-in-driven", "An update chooses slide in a driven scene without motion constants.", rule, then(one(), driven));
  c.invalid("contact-too-wide", "A difference of the point has 33 bits.", {"malformed", "R-RNG-4"}, [] {
    Stream stream(one());
    stream.add({.tick = 10, .updates = {Update{}}, .key = true});
    return stream
        .add_packet(10, coded_packet(1,
                                     [](RangeEncoder& coder, RigidModels& models) {
                                       coder.bit(models.key, 0);
                                       coder.magnitude(models.tick_delta, 0);
                                       coder.tree<2>(models.reason, 2);
                                       coder.tree<4>(models.level, 0);
                                       coder.tree<2>(models.predictor[6], kDriven);
                                       coder.raw(1, 0);
                                       coder.tree<4>(models.contact[0], 15);
                                       coder.raw(5, 18);
                                     }))
        .bytes();
  }());
}

void add_client_driven(Catalogue& c) {
  c.section(section::kDriven);
  const auto device = [&](const char* name, const char* what, Bytes bytes) {
    c.valid(name, what, std::move(bytes), {}, "device");
  };
  device("pushed", "The client's device pushes a cube along a line, loses it, and pushes again.", pushed(touched(), {}));
  device("pushed-and-turned", "The same about a screw.", pushed(touched(), {200, -300, 4000}));
  device("pushed-on-a-rail", "The same, the cube moves along x alone.", pushed(touched({}, Dof::x), {}));
  device("pushed-about-z", "The same, the cube moves along x and y and turns about z.",
         pushed(touched({}, Dof::x | Dof::y | Dof::rz), {0, 0, 4000}));
  device("pushed-without-gravity", "The same in a scene without motion constants.",
         pushed(with_driven({.objects = {{"device"}, {"cube"}}}, {kNone, {}}), {0, 0, 900}));
  device("pushed-without-friction", "The proxy slides at once.", pushed(touched({.friction = 0}), {0, 0, 900}));
  device("held", "The device lifts a cube, swings it, and goes away.", held(touched()));
  device("held-stiffly", "The same with the stiffest coupling.", held(touched({.hold = kMost})));
  device("held-on-a-rail", "The same, the cube moves along z alone.", held(touched({}, Dof::z)));
  device("before-the-device", "An update before anything is known of the device, and one after.", before_the_device());
  RawHeader brief = touched();
  brief.max_extrapolation = 30;
  device("pushed-for-30-ms", "The same, with max_extrapolation 30.", pushed(brief, {}));
  device("slowest-screw", "Velocities of 2^-18 to 2^-16 m/s: 2^-17 is the least that makes a screw.", slowest());
  device("at-the-face", "The device at the face, and 2^-28 m to either side.", at_the_face());
  device("far-off", "A device 1 m off: the proxy slides to the end of its range.", far_off({.friction = 0}));
  device("far-off-rough", "The same with the roughest proxy.", far_off({.friction = 65535}));
  device("lightest", "A gravity of 2^-16 m/s^2, and the strongest friction of the ground.",
         on_the_ground({0, 0, -1}, kMost / 4, 16));
  device("weightless", "A gravity of 2^-17 m/s^2, which is none here.", on_the_ground({0, 0, -1}, 4, 18));
  device("heaviest", "The strongest gravity along all axes, on a coarse grid.",
         on_the_ground({1 << 28, -(1 << 28), 1 << 28}, 1 << 28, 10));
  device("lifted", "Little weight and much friction: the device takes all of the load.",
         on_the_ground({100, 0, -60000}, 1 << 26, 17));
  device("slow-clock", "A tick in a second: the longest steps there are.", slow_clock());
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u, 5u, 6u})
    device(("driven-" + std::to_string(seed)).c_str(), "Any constants, contacts and velocities, eased.", random_contacts(seed));
}

}  // namespace tactus::conformance
