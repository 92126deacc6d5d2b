// SPDX-License-Identifier: Apache-2.0
/// Bases of clusters.
#include <functional>
#include <utility>

#include <tactus/deformable/cluster_basis.h>

#include "conformance/make_vectors/catalogue.h"
#include "conformance/make_vectors/deformable_build.h"
#include "conformance/make_vectors/sections.h"

namespace tactus::conformance {
namespace {

/// Vertex v is in cluster label(v).
RawDeformable in_clusters(RawDeformable item, std::uint8_t count, std::uint8_t blend, const std::function<int(int)>& label) {
  DeformableObject object;
  object.rest = item.shape.rest;
  object.triangles = item.shape.triangles;
  const Neighbours near = neighbours(object);
  std::vector<std::uint8_t> clusters;
  item.clusters = {count, blend, {}};
  std::uint32_t end = 0;
  for (std::uint32_t v = 0; v < object.rest.size(); ++v) {
    clusters.push_back(static_cast<std::uint8_t>(label(static_cast<int>(v))));
    if (expected_cluster(near[v], clusters, v) == clusters[v]) continue;
    item.clusters.surprises.push_back({v - end, clusters[v]});
    end = v + 1;
  }
  return item;
}

/// Parts that share no edge, and a vertex without triangles.
Shape parts() {
  Shape out = both(sheet(2, 2), moved(sheet(2, 2), {90000, -70000, 3000}));
  out.rest.push_back({5, 6, 7});
  return out;
}

/// Six vertices in a tilted plane but for one, which lies so far above it.
Shape tilted(std::int32_t above) {
  constexpr std::int32_t kEdge = 1 << 16;
  Shape out{{}, {{0, 1, 3}, {0, 3, 2}, {1, 4, 5}, {1, 5, 3}}};
  for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}, {2, 0}, {2, 1}})
    out.rest.push_back({x * kEdge, y * kEdge, (x + y) * kEdge});
  out.rest[3][2] += above;
  return out;
}

void add_valid(Catalogue& c) {
  c.section(section::kClusters);
  const auto thirds = [](int v) { return v / 12; };
  c.valid("clusters", "A closed box in three clusters that are not blended.",
          random_walk(in_clusters({.shape = box(4, 3, 1)}, 4, 0, thirds), 780, 12, 4), {"R-DEF-7"});
  c.valid("clusters-blended", "The same, blended over three edges; what is outside the basis fades.",
          random_walk(in_clusters({.shape = box(4, 3, 1), .fade = 7000}, 4, 3, thirds), 781, 16, 4));
  const Shape flat{{{0, 0, 0}, {4000, 0, 0}, {0, 4000, 0}, {4000, 4000, 0}, {8000, 0, 0}, {8000, 4000, 0}},
                   {{0, 1, 3}, {0, 3, 2}, {1, 4, 5}, {1, 5, 3}}};
  c.valid("clusters-of-a-flat-sheet", "The function along the normal is 0.",
          random_walk(in_clusters({.shape = flat}, 2, 1, [](int v) { return v / 4; }), 782, 8));
  const auto together = [](int) { return 0; };
  c.valid("clusters-nearly-flat", "What is left of the third function is 2^-30.8 of the height: rounding, and 0.",
          random_walk(in_clusters({.shape = tilted(8)}, 1, 0, together), 791, 4));
  c.valid("clusters-not-quite-flat", "What is left is 2^-29.7 of the height, and counts.",
          random_walk(in_clusters({.shape = tilted(12)}, 1, 0, together), 792, 4));
  c.valid("clusters-of-which-one-is-empty", "A cluster without a vertex has modes of 0.",
          random_walk(in_clusters({.shape = sheet(3, 3)}, 4, 2, [](int v) { return v < 8    ? 0
                                                                                   : v < 12 ? 3
                                                                                            : 2; }), 783, 8));
  c.valid("clusters-in-parts",
          "What no edge joins is not blended; the cluster of the lowest neighbour, of the vertex before, and 0 are expected.",
          random_walk(in_clusters({.shape = parts(), .weight_sets = 6}, 5, 4, [](int v) { return v < 4    ? 0
                                                                                                 : v < 12 ? 4
                                                                                                          : 2; }),
                      784, 12));
  c.valid("clusters-of-many",
          "More than four clusters around a vertex: the largest shares are kept, of equal ones those of lower numbers.",
          random_walk(in_clusters({.shape = flat_fan(12)}, 9, 2, [](int v) { return v % 9; }), 785, 4));
  c.valid("clusters-64", "As many clusters as there may be, blended as often as that may be.",
          random_walk(in_clusters({.shape = box(4, 4, 2)}, 64, 32, [](int v) { return (7 * v) % 64; }), 786, 3));
  c.valid("clusters-of-copies", "Vertices at one rest position are neighbours.",
          random_walk(in_clusters({.shape = both(sheet(2, 2), sheet(2, 2))}, 2, 1, [](int v) { return v / 9; }), 787, 6));
  const Shape far{{{-2147483647 - 1, 0, 5}, {2147483647, -2147483647 - 1, 0}, {0, 2147483647, 0}, {1, 2, 3}},
                  {{0, 1, 2}, {1, 2, 3}}};
  c.valid("clusters-of-far-vertices", "Rest positions at both ends of 32 bits.",
          random_walk(in_clusters({.shape = far}, 2, 1, [](int v) { return v / 3; }), 788, 4));
  c.valid("clusters-of-one-vertex", "The functions along the axes are 0.",
          random_walk(in_clusters({.shape = one_vertex()}, 1, 5, together), 789, 4));
  c.valid("clusters-in-layers", "Both layers of an object in clusters.",
          random_walk(in_clusters({.shape = sheet(5, 4), .layered = 1, .fade = 7000, .weight_sets = 7}, 3, 2,
                                  [](int v) { return v / 10; }),
                      790, 24, 3));
}

void add_faults(Catalogue& c) {
  const Rejection cut{"truncated", "R-STR-5"}, overlong{"malformed", "R-STR-5"}, basis{"invalid", "R-DEF-7"};
  const auto with = [](const Bytes& bytes) { return only({.basis = bytes}).bytes(); };  // one triangle
  c.section(section::kDeformable);
  c.invalid("clusters-cut", "The body ends before cluster_count.", cut, with({3}));
  c.invalid("no-blend", "The body ends before blend.", cut, with({3, 1}));
  c.invalid("no-surprise-count", "The body ends before surprise_count.", cut, with({3, 1, 0}));
  c.invalid("cluster-count-0", "No cluster.", basis, with({3, 0, 0, 0}));
  c.invalid("cluster-count-65", "65 clusters.", basis, with({3, 65, 0, 0}));
  c.invalid("blend-33", "blend is 33.", basis, with({3, 2, 33, 0}));
  c.invalid("no-room-for-surprises", "One byte too few for two surprises.", cut, with({3, 3, 0, 2, 0, 1, 0}));
  c.invalid("blend-before-room", "blend is 33; one byte too few for two surprises.", {"invalid", "R-DEF-7", "R-STR-5"},
            with({3, 3, 33, 2, 0, 1, 0}));
  c.invalid("overlong-surprise", "gap 0 is written in two bytes.", overlong, with({3, 2, 0, 1, 0x80, 0x00, 1}));
  c.invalid("surprise-cut", "The body ends inside cluster.", cut, with({3, 2, 0, 1, 1, 0x80}));
  c.invalid("surprise-of-no-vertex", "A surprise at vertex 3 of 3.", basis, with({3, 2, 0, 1, 3, 1}));
  c.invalid("second-surprise-of-no-vertex", "The second surprise is at vertex 3 of 3.", basis, with({3, 3, 0, 2, 1, 1, 1, 2}));
  c.invalid("surprise-of-no-cluster", "A surprise names cluster 2 of 2.", basis, with({3, 2, 0, 1, 1, 2}));
  c.invalid("surprise-gap-of-64-bits", "gap is 2^64 - 1.", basis, with(Bytes{3, 2, 0, 1} + varint(~std::uint64_t{0}) + Bytes{1}));
  c.invalid("surprise-as-expected", "Vertex 1 is in the cluster of its lowest neighbour.", basis, with({3, 2, 0, 2, 0, 1, 0, 1}));
  c.invalid("first-surprise-as-expected", "Vertex 0 is in cluster 0.", basis, with({3, 2, 0, 1, 0, 0}));
}

/// Clusters of so many vertices in one place, and 64 modes of 1024 others.
Input much_work(std::size_t vertices, std::uint8_t blend) {
  Shape dust;
  for (std::int32_t v = 0; v < 1024; ++v) dust.rest.push_back({100 * v, v * v % 1000, 7 * v % 300});
  const RawDeformable springs{.shape = dust, .name = "springs", .spring_modes = 64};
  RawHeader header;
  header.objects.clear();
  const RawDeformable clusters{.shape = {std::vector<Vec3i>(vertices), {}}, .clusters = {1, blend, {}}};
  Bytes all = with_deformables(header, {clusters, springs}).bytes();
  const std::size_t zeros = 3 * vertices;
  const std::size_t end = all.size() - 4 - springs.bytes().size() - 4;  // crc; basis, cluster_count, blend and surprise_count
  return {std::move(all), {end - zeros, {0}, zeros}};
}

void add_limits(Catalogue& c) {
  c.section(section::kLimits);
  const Rejection work{"limit_exceeded", "R-STR-21"};
  c.invalid("work-of-clusters-and-springs",
            "345000 vertices, blended 32 times, and 64 modes of 1024 others: too much work together.", work,
            much_work(345000, 32));
  c.invalid("work-just-over-the-limit", "325442 vertices, blended 31 times, and 64 modes of 1024 others: work of 2^22 + 1.", work,
            much_work(325442, 31));
}

/// What is small beside its distance from the origin.
void add_far(Catalogue& c) {
  c.section(section::kClusters);
  const Shape far = moved(sheet(3, 2), {2000000000, -2000000000, 1900000000});
  c.valid("clusters-far-from-the-origin", "Functions count from the first vertex of a cluster: none is lost beside the distance.",
          random_walk(in_clusters({.shape = far}, 2, 1, [](int v) { return v / 6; }), 793, 6));
}

}  // namespace

void add_deformable_clusters(Catalogue& c) {
  add_valid(c);
  add_faults(c);
  add_limits(c);
  add_far(c);
}

}  // namespace tactus::conformance
