// SPDX-License-Identifier: Apache-2.0
/// Declarations of elastic bodies.
#include <limits>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/elastic_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

constexpr double kMost = 1e15;
constexpr double kTiny = std::numeric_limits<double>::denorm_min();
constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();

ElasticItem of(const Block& block) { return {{.shape = block.shape}, standing(block)}; }

ElasticItem three_materials() {
  ElasticItem item = of(block(2, 1, 1));
  item.body->materials = {{9000, 0.3, 1100}, {50000, 0, 900}, {700, -0.4, 2000}};
  item.body->lengths = {{3, 1}, {4, 0}, {1, 0}, {1, 2}, {3, 1}};
  return item;
}

ElasticItem at_most() {
  ElasticItem item = cube();
  item.body->constants = {kMost, kMost, kMost, -kMost, kMost, kMost, kMost};
  item.body->materials = {{kMost, 0.49999999999999994, kMost}};
  return item;
}

ElasticItem at_least() {
  ElasticItem item = cube();
  item.body->constants = {-0.0, 0, -0.0, 0, -kMost, kTiny, -0.0};
  item.body->materials = {{kTiny, -0.9999999999999999, kTiny}};
  return item;
}

/// Every f64 is another one.
ElasticItem all_materials() {
  ElasticItem item = cube();
  item.body->materials.clear();
  for (int i = 0; i < 255; ++i) item.body->materials.push_back({1 + i * 0.37, -0.9 + i * 0.005, 0.1 + i});
  item.body->lengths = {{1, 254}, {2, 0}, {3, 128}};
  return item;
}

Bytes after_all_else() {
  RawHeader header{.objects = {{"device"}, {"wall", Dof::none}}};
  header = with_elastic(header, {{{.name = "plain"}}, cube()});
  header.flags |= 2 | 4 | 8 | 16;
  header.loads = {4, 2};
  ByteWriter m(header.motion);
  for (const std::int32_t c : {0, 0, -1000, 300}) m.i32(c);
  ByteWriter d(header.driven);
  for (const std::uint32_t c : {9u, 9u, 1u, 2u, 3u}) d.u32(c);
  d.u16(1);
  d.u16(2);
  header.extensions = varint(77) + varint(2) + Bytes{1, 2};
  return header.bytes();
}

/// A vertex in no tetrahedron is fixed; seven of the cube's are, too.
ElasticItem one_free_vertex() {
  ElasticItem item = cube();
  item.body->inner = {{-5, 70000, 12345}};
  item.body->runs = {{0, 2}, {1, 4}};
  return item;
}

/// Two cubes apart from each other, with inner vertices, and all of it upside down in the list.
ElasticItem two_parts() {
  const Block one = block(2, 2, 2, 9000);
  ElasticItem item{{.shape = both(one.shape, moved(block(1, 2, 1, 11000).shape, {90000, -80000, 7}))}, loose(one)};
  const auto begin = static_cast<std::uint32_t>(one.shape.rest.size());
  const Block other = block(1, 2, 1, 11000);
  const auto all = static_cast<std::uint32_t>(item.object.shape.rest.size());
  for (Corners& tet : item.body->tets)
    for (std::uint32_t& corner : tet) corner = corner < begin ? corner : corner - begin + all;
  for (const Corners& tet : other.tets)
    item.body->tets.insert(item.body->tets.begin(), {tet[0] + begin, tet[1] + begin, tet[2] + begin, tet[3] + begin});
  item.body->runs = {{1, 0}, {7, 1}, {20, 0}};
  return item;
}

ElasticItem far_vertices() {
  ElasticItem item{
      {.shape = {{{-kLargest - 1, -kLargest - 1, -kLargest - 1}, {kLargest, -5, 9}, {0, kLargest, -3}}, {{0, 1, 2}}}}, RawBody{}};
  item.body->inner = {{7, 8, kLargest}};
  item.body->tets = {{0, 1, 2, 3}};
  return item;
}

/// In the rounded arithmetic of the specification its volume is above 0; it is 0.
ElasticItem thinnest() {
  ElasticItem item{{.shape = {{{0, 0, 0}, {43693036, 74747412, 742162239}, {-566713130, 557718450, 148535145}}, {}}}, RawBody{}};
  item.body->inner = {{-261510047, 316232931, 445348692}};
  item.body->tets = {{0, 1, 2, 3}};
  return item;
}

/// Any order of elimination; vertices in no tetrahedron are fixed, and the first two.
ElasticItem tangled(std::uint32_t vertices) {
  const Block any = tangle(vertices, 3 * vertices / 4, vertices);
  ElasticItem item{{.shape = any.shape}, loose(any)};
  std::vector<std::uint8_t> is_free(vertices, 0);
  for (const Corners& tet : any.tets)
    for (const std::uint32_t corner : tet) is_free[corner] = 1;
  is_free[0] = is_free[1] = 0;
  std::vector<std::uint32_t> fixed;
  for (std::uint32_t v = 0; v < vertices; ++v)
    if (is_free[v] == 0) fixed.push_back(v);
  item.body->runs = runs_of(fixed);
  return item;
}

void add_valid(Catalogue& c) {
  c.section(section::kElastic);
  const auto valid = [&](const char* name, const char* what, const ElasticItem& item, std::vector<std::string> rules = {}) {
    c.valid(name, what, only(item).bytes(), std::move(rules));
  };
  valid("elastic", "A cube of eight vertices and six tetrahedra.", cube(), {"R-STR-4"});
  valid("elastic-inner", "27 vertices, one of them inside.", of(block(2, 2, 2)));
  valid("elastic-materials", "Three materials, two runs of which are of the same one.", three_materials(), {"R-ELA-3"});
  valid("elastic-255-materials", "255 materials, three of which are used.", all_materials(), {"R-ELA-3"});
  valid("elastic-most", "The largest constants.", at_most(), {"R-ELA-2"});
  valid("elastic-least", "The least constants, some of them -0.", at_least(), {"R-ELA-2"});
  valid("elastic-one-free-vertex", "All vertices but one are fixed; one of these is in no tetrahedron.", one_free_vertex(),
        {"R-ELA-4"});
  valid("elastic-parts", "Two parts with inner and fixed vertices.", two_parts());
  valid("elastic-far-vertices", "Rest positions at both ends of 32 bits.", far_vertices(), {"R-DEF-5"});
  valid("elastic-thinnest", "A flat tetrahedron whose volume is above 0 after rounding.", thinnest(), {"R-ELA-4"});
  ElasticItem slow = cube();
  slow.object.frame_period = 1u << 18;
  valid("elastic-longest-frame", "A frame of 1024 ticks.", slow, {"R-ELA-1"});
  c.valid("elastic-one-of-three", "Of three objects, one of profile thesis, the last has a body.",
          [] {
            RawHeader header;
            header.objects.clear();
            ElasticItem last = cube();
            last.object.name = "cube";
            return with_elastic(header, {{{.name = "plain"}}, {{.profile = 0, .name = "old"}}, last}).bytes();
          }(),
          {"R-ELA-1"});
  c.valid("elastic-after-all-else", "Loads, motion constants, driven objects, elastic bodies, an extension.", after_all_else());
  for (const std::uint32_t vertices : {9u, 16u, 30u, 60u, 200u})
    valid(("elastic-order-" + std::to_string(vertices)).c_str(), "Tetrahedra between any vertices: the work tells the order.",
          tangled(vertices));
  valid("elastic-work-at-limit", "Work of 2^30 - 323742.", heaviest(kMostTets), {"R-STR-24"});
}

}  // namespace

void add_scene_elastic(Catalogue& c) { add_valid(c); }

}  // namespace tactus::conformance
