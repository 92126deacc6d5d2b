// SPDX-License-Identifier: Apache-2.0
/// Two faults at once where a declaration tells elastic bodies, and bodies that take too much work.
#include <limits>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/elastic_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// The cube's body without what follows its materials.
Bytes constants(std::uint8_t materials = 1, double mass_damping = 0) {
  RawBody body;
  body.constants[kMassDamping] = mass_damping;
  body.materials.assign(materials, {20000, 0.4, 1000});
  return without_last(body.bytes(), 3);
}

Bytes with(const Bytes& body, RawDeformable object = cube().object) {
  ElasticItem item = cube();
  item.object = std::move(object);
  RawHeader header = only(item);
  header.elastic = body;
  return header.bytes();
}

void add_orders(Catalogue& c) {
  const auto order = [&](const char* name, const char* what, const Rejection& rejection, Bytes bytes) {
    c.invalid(name, what, rejection, std::move(bytes));
  };
  RawDeformable layered = cube().object, thesis = cube().object;
  layered.layered = 1;
  thesis.profile = 0;
  order("thesis-before-elastic-cut", "A body of profile thesis, and the declaration ends after has_body.",
        {"invalid", "R-ELA-1", "R-STR-5"}, with({1}, thesis));
  order("layered-before-elastic-constants", "A body with layers, whose mass_damping is NaN.", {"invalid", "R-ELA-1", "R-ELA-2"},
        with(constants(1, kNan) + Bytes{0, 1, 0, 2, 2, 2, 0}, layered));
  order("elastic-cut-before-constants", "mass_damping is NaN; the body ends inside density.", {"truncated", "R-STR-5", "R-ELA-2"},
        with(without_last(constants(1, kNan), 1)));
  order("elastic-constants-before-cut", "mass_damping is NaN; the body ends before inner_count.",
        {"invalid", "R-ELA-2", "R-STR-5"}, with(constants(1, kNan)));
  order("elastic-cut-before-inner-count", "inner_count is 2^21; the body ends before tet_count.",
        {"truncated", "R-STR-5", "R-ELA-3"}, with(constants() + varint(1u << 21)));
  order("elastic-count-before-room", "tet_count is 2^22, and nothing follows.", {"invalid", "R-ELA-3", "R-STR-5"},
        with(constants() + varint(0) + varint(1u << 22)));
  order("elastic-room-before-inner", "A coordinate of 2^31; one byte too few for two tetrahedra.",
        {"truncated", "R-STR-5", "R-DEF-5"},
        with(constants() + Bytes{1, 2} + zigzag_varint(std::int64_t{1} << 31) + Bytes(5, 0)));
  order("elastic-inner-before-tets", "A coordinate of 2^31; a tetrahedron of one vertex.", {"invalid", "R-DEF-5", "R-ELA-3"},
        with(constants() + Bytes{1, 1} + zigzag_varint(std::int64_t{1} << 31) + Bytes(7, 0)));
  order("elastic-cut-before-corners", "The first corner is vertex 8 of 8; the body ends inside the last one.",
        {"truncated", "R-STR-5", "R-ELA-3"}, with(constants() + Bytes{0, 1, 16, 2, 2, 0x80}));
  order("elastic-corners-before-cut", "Corners of one vertex; the body ends inside the next tetrahedron.",
        {"invalid", "R-ELA-3", "R-STR-5"}, with(constants() + Bytes{0, 2, 0, 0, 2, 2, 0, 2, 2, 0x80}));
  const Bytes tet{1, 1, 2, 2, 2, 0, 2, 2, 2};
  order("elastic-cut-before-length", "length is 0; the body ends before material.", {"truncated", "R-STR-5", "R-ELA-3"},
        with(constants(2) + tet + Bytes{0}));
  order("elastic-length-before-cut", "length is 2 of 1 tetrahedron; the body ends before run_count.",
        {"invalid", "R-ELA-3", "R-STR-5"}, with(constants(2) + tet + Bytes{2, 0}));
  order("elastic-room-before-runs", "A run begins at vertex 9 of 9; one byte too few for two.",
        {"truncated", "R-STR-5", "R-ELA-3"}, with(constants() + tet + Bytes{2, 9, 0, 1}));
  order("elastic-cut-before-run", "A run begins at vertex 9 of 9; the body ends inside more.",
        {"truncated", "R-STR-5", "R-ELA-3"}, with(constants() + tet + Bytes{1, 9, 0x80}));
  order("elastic-run-before-cut", "A run begins at vertex 9 of 9, and the next one is cut.", {"invalid", "R-ELA-3", "R-STR-5"},
        with(constants() + tet + Bytes{2, 9, 0, 0x80, 0x80}));
  order("elastic-runs-before-solid", "A flat tetrahedron; a run begins at vertex 9 of 9.", {"invalid", "R-ELA-3", "R-ELA-4"},
        with(constants() + Bytes{1, 1, 0, 0, 0, 0, 2, 2, 2, 1, 9, 0}));
  RawHeader two;
  two.objects.clear();
  ElasticItem flat = cube(), other = cube();
  std::swap(flat.body->tets[0][0], flat.body->tets[0][1]);
  other.object.name = "other";
  other.body->has_body = 2;
  order("elastic-solid-before-next", "The first body has a tetrahedron inside out, the second object's has_body is 2.",
        {"invalid", "R-ELA-4", "R-ELA-1"}, with_elastic(two, {flat, other}).bytes());
  RawHeader none = only(cube());
  none.elastic = {0};
  none.extensions = {5};
  order("elastic-nothing-before-extension", "No object has a body; then an extension without a size.",
        {"invalid", "R-ELA-1", "R-STR-16"}, none.bytes());
  RawHeader driven{.objects = {{"device"}}};
  driven.driven = Bytes(24, 0);
  driven.flags = 16;
  ElasticItem wrong = cube();
  wrong.body->has_body = 2;
  order("driven-before-elastic", "All constants of driven objects are 0, and has_body is 2.", {"invalid", "R-STR-23", "R-ELA-1"},
        with_elastic(driven, {wrong}).bytes());
  other = flat;
  other.object.name = "cube";
  order("elastic-solid-before-names", "A tetrahedron inside out, and an object of the same name.",
        {"invalid", "R-ELA-4", "R-STR-11"}, with_elastic({}, {other}).bytes());
}

void add_limits(Catalogue& c) {
  const Rejection rule{"limit_exceeded", "R-STR-24"};
  c.invalid("elastic-work", "One tetrahedron more: work of 2^30 + 650688.", rule, only(heaviest(kMostTets + 1)).bytes());
  RawHeader two;
  two.objects.clear();
  ElasticItem a = heaviest(1200), b = a;
  b.object.name = "other";
  c.invalid("elastic-work-of-all", "Two bodies, each below the limit.", rule, with_elastic(two, {a, b}).bytes());
  ElasticItem named = heaviest(kMostTets + 1);
  named.object.name = "cube";
  c.invalid("names-before-elastic-work", "Two objects of one name, and too much work.", {"invalid", "R-STR-11", "R-STR-24"},
            with_elastic({}, {named}).bytes());
  std::vector<ElasticItem> large{{heaviest(kMostTets + 1)}};
  RawHeader span;
  span.objects.clear();
  span.baseline_span = 64;
  for (const RawDeformable& object : with_large_states(250)) large.push_back({object});
  c.invalid("states-before-elastic-work", "Too large states, and too much work.", {"limit_exceeded", "R-STR-18", "R-STR-24"},
            with_elastic(span, large).bytes());
  ElasticItem modes = heaviest(kMostTets + 1);
  modes.object.spring_modes = 64;
  std::vector<ElasticItem> many{modes};
  for (int i = 0; i < 5; ++i)
    many.push_back({{.shape = tangle(1024, 0, 9).shape, .name = std::to_string(i), .spring_modes = 64}});
  c.invalid("basis-before-elastic-work", "Too much work for the bases, and for the body.",
            {"limit_exceeded", "R-STR-21", "R-STR-24"}, with_elastic(two, many).bytes());
}

}  // namespace

void add_scene_elastic_orders(Catalogue& c) {
  add_orders(c);
  add_limits(c);
}

}  // namespace tactus::conformance
