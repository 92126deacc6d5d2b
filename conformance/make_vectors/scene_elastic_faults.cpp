// SPDX-License-Identifier: Apache-2.0
/// Elastic bodies that break a rule.
#include <bit>
#include <limits>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/elastic_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

constexpr double kBeyond = 1000000000000000.125;  // the double after 10^15, the largest allowed
constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinite = std::numeric_limits<double>::infinity();
constexpr double kTiny = std::numeric_limits<double>::denorm_min();
constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();
constexpr std::uint64_t kAll = ~std::uint64_t{0};

const Rejection cut{"truncated", "R-STR-5"}, overlong{"malformed", "R-STR-5"};

/// The cube after one change. Its vertices are 0 to 7, and 8 if there is an inner one; 0 to 3 are fixed.
template <class Change>
Bytes changed(Change change) {
  ElasticItem item = cube();
  change(item.object, *item.body);
  return only(item).bytes();
}
template <class Change>
Bytes changed_body(Change change) {
  return changed([&](RawDeformable&, RawBody& body) { change(body); });
}

/// The cube declared by these bytes, in place of its body.
Bytes with(const Bytes& body) {
  RawHeader header = only(cube());
  header.elastic = body;
  return header.bytes();
}
/// The cube up to the last density.
Bytes constants(std::uint8_t materials = 1) {
  RawBody body;
  body.materials.assign(materials, {20000, 0.4, 1000});
  return without_last(body.bytes(), 3);
}
/// The same with an inner vertex and one tetrahedron, and what follows these.
Bytes one_tet(std::uint8_t materials, const Bytes& rest) {
  return with(constants(materials) + varint(1) + varint(1) + Bytes{2, 2, 2} + Bytes{0, 2, 2, 2} + rest);
}

void add_objects(Catalogue& c) {
  const Rejection rule{"invalid", "R-ELA-1"};
  c.invalid("has-body-2", "has_body is 2.", {"malformed", "R-ELA-1"}, changed_body([](RawBody& b) { b.has_body = 2; }));
  c.invalid("elastic-thesis", "A body of an object of profile thesis.", rule,
            changed([](RawDeformable& o, RawBody&) { o.profile = 0; }));
  c.invalid("elastic-layered", "A body of an object with layers.", rule,
            changed([](RawDeformable& o, RawBody&) { o.layered = 1; }));
  for (const std::uint32_t period : {1u, 255u, 257u, 16640u + 128u})
    c.invalid("elastic-frame-period-" + std::to_string(period), "A body whose frames are not whole ticks.", rule,
              changed([&](RawDeformable& o, RawBody&) { o.frame_period = period; }));
  c.invalid("elastic-frame-of-1025-ticks", "A body whose frames are too long.", rule,
            changed([](RawDeformable& o, RawBody&) { o.frame_period = (1u << 18) + 256; }));
  c.invalid("elastic-nothing", "The flag is set, and no object has a body.", rule, with({0}));
  RawHeader none;
  none.flags = 32;
  c.invalid("elastic-without-objects", "The flag is set, and there are no deformable objects.", rule, none.bytes());
}

void add_constants(Catalogue& c) {
  const Rejection rule{"invalid", "R-ELA-2"};
  struct Wrong {
    const char* name;
    const char* what;
    double value;
  };
  const Wrong nan{"nan", "NaN", kNan}, infinite{"infinite", "infinite", kInfinite},
      beyond{"beyond", "the next above 10^15", kBeyond}, negative{"negative", "-2^-1074", -kTiny}, zero{"0", "0", 0},
      below{"below", "the next below -10^15", -kBeyond};
  const auto of = [&](const std::string& name, const std::vector<Wrong>& values, auto set) {
    std::string dashed = name;
    for (char& ch : dashed)
      if (ch == '_' || ch == '.') ch = '-';
    for (const Wrong& wrong : values)
      c.invalid("elastic-" + dashed + '-' + wrong.name, name + " is " + wrong.what + '.', rule,
                changed_body([&](RawBody& b) { set(b, wrong.value); }));
  };
  const auto constant = [](std::size_t which) { return [which](RawBody& b, double value) { b.constants[which] = value; }; };
  const auto material = [](std::size_t which) { return [which](RawBody& b, double value) { b.materials[0][which] = value; }; };
  of("mass_damping", {negative, nan, infinite, beyond}, constant(kMassDamping));
  of("stiffness_damping", {negative, nan, infinite, beyond}, constant(kStiffnessDamping));
  of("gravity.x", {below, beyond, nan}, constant(kGravityX));
  of("gravity.y", {below, beyond, infinite}, constant(kGravityY));
  of("gravity.z", {below, beyond, nan, infinite}, constant(kGravityZ));
  of("coupling", {zero, negative, nan, infinite, beyond}, constant(kCoupling));
  of("friction", {negative, nan, infinite, beyond}, constant(kFriction));
  of("young", {zero, negative, nan, infinite, beyond}, material(0));
  of("poisson", {{"-1", "-1", -1}, {"half", "0.5", 0.5}, nan, infinite, {"-infinite", "-infinite", -kInfinite}}, material(1));
  of("density", {zero, negative, nan, infinite, beyond}, material(2));
  c.invalid("elastic-second-material", "The second material's poisson is 0.5.", rule, changed_body([](RawBody& b) {
              b.materials.push_back({1, 0.5, 1});
              b.lengths = {{6, 0}};
            }));
  c.invalid("elastic-no-material", "material_count is 0.", rule, changed_body([](RawBody& b) { b.materials.clear(); }));
}

void add_parts(Catalogue& c) {
  const Rejection rule{"invalid", "R-ELA-3"};
  const auto counts = [&](std::uint64_t inner, std::uint64_t tets) {
    return with(constants() + varint(inner) + varint(tets) + Bytes(40, 0));
  };
  c.invalid("elastic-vertices-beyond", "2^20 + 1 vertices, eight of them of the object.", rule, counts((1u << 20) - 7, 1));
  c.invalid("elastic-inner-of-64-bits", "inner_count is 2^64 - 1.", rule, counts(kAll, 1));
  c.invalid("elastic-no-tet", "tet_count is 0.", rule, counts(0, 0));
  c.invalid("elastic-tets-beyond", "tet_count is 2^21 + 1.", rule, counts(0, (1u << 21) + 1));
  c.invalid("elastic-tets-of-64-bits", "tet_count is 2^64 - 1.", rule, counts(0, kAll));
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j)
      c.invalid("elastic-corner-twice-" + std::to_string(i) + std::to_string(j), "Two corners of a tetrahedron are one vertex.",
                rule, changed_body([&](RawBody& b) { b.tets[2][j] = b.tets[2][i]; }));
  for (std::size_t i = 0; i < 4; ++i)
    c.invalid("elastic-corner-beyond-" + std::to_string(i), "A corner of a tetrahedron is vertex 8 of 8.", rule,
              changed_body([&](RawBody& b) { b.tets[5][i] = 8; }));
  c.invalid("elastic-corner-negative", "The second corner is vertex -1.", rule,
            with(constants() + varint(0) + varint(1) + Bytes{0, 1, 4, 2, 0}));
  c.invalid("elastic-corner-of-64-bits", "A difference of 2^63 - 1, and back.", rule,
            with(constants() + varint(0) + varint(1) + Bytes{0, 2} + varint(kAll - 1) + varint(kAll - 4) + Bytes(9, 0)));
  const auto lengths = [&](std::vector<std::pair<std::uint64_t, std::uint8_t>> list) {
    return changed_body([&](RawBody& b) {
      b.materials.assign(2, b.materials[0]);
      b.lengths = std::move(list);
    });
  };
  c.invalid("elastic-length-0", "A run of no tetrahedron.", rule, lengths({{2, 0}, {0, 1}, {4, 0}}));
  c.invalid("elastic-length-beyond", "Materials of seven tetrahedra; there are six.", rule, lengths({{2, 0}, {5, 1}}));
  c.invalid("elastic-length-of-64-bits", "length is 2^64 - 1: in 64-bit arithmetic the run would end at tetrahedron 1.", rule,
            lengths({{2, 0}, {kAll, 1}}));
  c.invalid("elastic-material-beyond", "A run of material 2 of 2.", rule, lengths({{2, 0}, {4, 2}}));
  const auto runs = [&](std::vector<std::array<std::uint64_t, 2>> list) {
    return changed_body([&](RawBody& b) { b.runs = std::move(list); });
  };
  c.invalid("elastic-run-without-gap", "The second run touches the first.", rule, runs({{1, 0}, {0, 0}}));
  c.invalid("elastic-run-of-no-vertex", "A run begins at vertex 8 of 8.", rule, runs({{8, 0}}));
  c.invalid("elastic-run-too-long", "A run ends at vertex 8 of 8.", rule, runs({{3, 5}}));
  c.invalid("elastic-second-run-too-long", "The second run ends at vertex 8 of 8.", rule, runs({{0, 1}, {2, 4}}));
  c.invalid("elastic-run-after-all", "A run after one that ends at the last vertex.", rule, runs({{4, 3}, {1, 0}}));
  c.invalid("elastic-gap-of-64-bits", "gap is 2^64 - 1: in 64-bit arithmetic the run would end at vertex 0.", rule,
            runs({{kAll, 1}}));
  c.invalid("elastic-inner-fixed-too-far", "With an inner vertex a run ends at vertex 9 of 9.", rule,
            changed_body([](RawBody& b) {
              b.inner = {{1, 2, 3}};
              b.runs = {{8, 1}};
            }));
}

void add_solids(Catalogue& c) {
  const Rejection rule{"invalid", "R-ELA-4"};
  c.invalid("elastic-all-fixed", "All vertices are fixed.", rule, changed_body([](RawBody& b) { b.runs = {{0, 7}}; }));
  c.invalid("elastic-all-fixed-in-runs", "All vertices are fixed, the inner one in a tetrahedron, too.", rule,
            changed_body([](RawBody& b) {
              b.inner = {{1, 2, 3}};
              b.runs = {{0, 8}};
            }));
  c.invalid("elastic-flat", "A tetrahedron of four vertices in a plane.", rule, changed_body([](RawBody& b) {
              b.inner = {{42000, 42000, 0}};
              b.tets.push_back({0, 1, 2, 8});
            }));
  c.invalid("elastic-inverted", "The last tetrahedron is inside out.", rule,
            changed_body([](RawBody& b) { std::swap(b.tets[5][2], b.tets[5][3]); }));
  c.invalid("elastic-flat-when-rounded", "A tetrahedron whose volume is above 0, but rounds to 0.", rule, [] {
    ElasticItem item{{.shape = {{{0, 0, 0}, {248440060, -412319174, -75810074}, {-456349588, -352300627, 394376109}}, {}}},
                     RawBody{}};
    item.body->inner = {{-143601821, -253654104, 156929886}};
    item.body->tets = {{0, 1, 2, 3}};
    return only(item).bytes();
  }());
  c.invalid("elastic-vertex-in-none", "A free vertex of the object is in no tetrahedron.", rule,
            changed([](RawDeformable& o, RawBody&) {
              o.shape.rest.push_back({5, 5, 5});
            }));
  c.invalid("elastic-inner-in-none", "An inner vertex is in no tetrahedron, and free.", rule, changed_body([](RawBody& b) {
              b.inner = {{5, 5, 5}};
            }));
  c.invalid("elastic-inner-beyond-32-bits", "A coordinate of the second inner vertex is 2^31.", {"invalid", "R-DEF-5"},
            with(constants() + varint(2) + varint(1) + zigzag_varint(1) + zigzag_varint(kLargest) + zigzag_varint(0) +
                 zigzag_varint(1) + zigzag_varint(1) + Bytes(20, 0)));
}

void add_cuts(Catalogue& c) {
  const Bytes all = constants();
  c.invalid("elastic-empty", "The body ends before has_body.", cut, with({}));
  const struct {
    const char* where;
    std::size_t size;
  } cuts[]{{"mass_damping", 5}, {"friction", 56}, {"material_count", 57}, {"young", 60}, {"density", 81}, {"inner_count", 82}};
  for (const auto& [where, size] : cuts)
    c.invalid(std::string("elastic-cut-at-") + std::to_string(size), std::string("The body ends inside or before ") + where + '.',
              cut, with(first(all, size)));
  c.invalid("elastic-before-tet-count", "The body ends before tet_count.", cut, with(all + varint(0)));
  c.invalid("elastic-overlong-inner-count", "inner_count 0 is written in two bytes.", overlong,
            with(all + Bytes{0x80, 0x00, 1} + Bytes(9, 0)));
  c.invalid("elastic-overlong-tet-count", "tet_count 1 is written in two bytes.", overlong,
            with(all + Bytes{0, 0x81, 0x00} + Bytes(9, 0)));
  c.invalid("elastic-no-room-for-tets", "One byte too few for two inner vertices and three tetrahedra.", cut,
            with(all + Bytes{2, 3} + Bytes(17, 2)));
  c.invalid("elastic-most-vertices", "2^20 vertices and 2^21 tetrahedra, but no room for them.", cut,
            with(all + varint((1u << 20) - 8) + varint(1u << 21) + Bytes(40, 0)));
  c.invalid("elastic-cut-inner", "The body ends inside an inner vertex.", cut,
            with(all + Bytes{1, 1} + zigzag_varint(1 << 20) + zigzag_varint(1 << 20) + Bytes{0x80}));
  c.invalid("elastic-overlong-inner", "A coordinate 0 is written in two bytes.", overlong,
            with(all + Bytes{1, 1, 2, 0x80, 0x00, 2} + Bytes(9, 0)));
  c.invalid("elastic-cut-tet", "The body ends inside the second tetrahedron.", cut,
            with(all + Bytes{0, 2, 0x00, 0x0e, 0x01, 0x01, 0x02, 0x02, 0x02 | 0x80, 0x80}));
  c.invalid("elastic-overlong-corner", "A corner's difference 1 is written in two bytes.", overlong,
            with(all + Bytes{0, 1, 0, 0x82, 0x00, 2, 2, 0}));
  c.invalid("elastic-before-length", "The body ends before length.", cut, one_tet(2, {}));
  c.invalid("elastic-before-material", "The body ends before material.", cut, one_tet(2, {1}));
  c.invalid("elastic-overlong-length", "length 1 is written in two bytes.", overlong, one_tet(2, {0x81, 0x00, 0, 0}));
  c.invalid("elastic-before-run-count", "The body ends before run_count.", cut, one_tet(1, {}));
  c.invalid("elastic-no-room-for-runs", "One byte too few for two runs.", cut, one_tet(1, {2, 0, 0, 1}));
  c.invalid("elastic-cut-run", "The body ends inside more.", cut, one_tet(1, {1, 0, 0x80}));
  c.invalid("elastic-overlong-gap", "gap 0 is written in two bytes.", overlong, one_tet(1, {1, 0x80, 0x00, 0}));
  RawHeader two;
  two.objects.clear();
  two = with_elastic(two, {cube(), {{.name = "plain"}}});
  two.elastic.pop_back();
  c.invalid("elastic-second-missing", "The body ends before the second object's has_body.", cut, two.bytes());
}

}  // namespace

void add_scene_elastic_faults(Catalogue& c) {
  add_objects(c);
  add_constants(c);
  add_parts(c);
  add_solids(c);
  add_cuts(c);
}

}  // namespace tactus::conformance
