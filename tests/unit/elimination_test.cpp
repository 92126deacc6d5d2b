// SPDX-License-Identifier: Apache-2.0
#include <tactus/elastic/elastic_solver.h>

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/elastic_fixture.h"

namespace tactus {
namespace {

using testing::slab_mesh;
using testing::slab_physics;

TEST(Elimination, HasEveryFreeVertexOnce) {
  const ElasticBody body = slab_physics().body;
  const std::size_t vertices = slab_mesh().vertices.size();
  const Elimination found = elimination(body, vertices);
  EXPECT_EQ(found.order.size() + body.fixed.size(), vertices);
  for (std::uint32_t v = 0; v < vertices; ++v) {
    const bool is_fixed = std::ranges::binary_search(body.fixed, v);
    ASSERT_EQ(found.place[v] == Elimination::kFixed, is_fixed);
    if (!is_fixed) {
      EXPECT_EQ(found.order[found.place[v]], v);
    }
  }
}

TEST(Elimination, RowsBeginAtTheLowestNeighbour) {
  const ElasticBody body = slab_physics().body;
  const Elimination found = elimination(body, slab_mesh().vertices.size());
  std::vector<std::uint32_t> lowest(found.order.size());
  for (std::uint32_t i = 0; i < lowest.size(); ++i) lowest[i] = i;
  for (const ElasticBody::Tet& tet : body.tets)
    for (const std::uint32_t a : tet)
      for (const std::uint32_t b : tet)
        if (found.place[a] != Elimination::kFixed && found.place[b] != Elimination::kFixed)
          lowest[found.place[a]] = std::min(lowest[found.place[a]], found.place[b]);
  EXPECT_EQ(found.first, lowest);
}

/// The order keeps what is not 0 together: there are 50 free vertices, 10 in each cut through the slab.
TEST(Elimination, KeepsNeighboursClose) {
  const Elimination found = elimination(slab_physics().body, slab_mesh().vertices.size());
  for (std::uint32_t i = 0; i < found.first.size(); ++i) EXPECT_LT(i - found.first[i], 20u);
}

TEST(Elimination, CountsItsWork) {
  const Elimination two{.order = {4, 7}, .place = {}, .first = {0, 0}};
  std::uint64_t sum = 0;
  for (std::uint64_t width = 0; width < 6; ++width) sum += (width + 64) * (width + 64);
  EXPECT_EQ(elastic_work(two), sum);
}

TEST(Elimination, PartsComeOneAfterTheOther) {
  ElasticBody body;
  body.tets = {{0, 1, 2, 3}, {4, 5, 6, 7}};
  const Elimination found = elimination(body, 8);
  EXPECT_EQ(found.order, (std::vector<std::uint32_t>{6, 5, 4, 7, 2, 1, 0, 3}));
  EXPECT_EQ(found.first, (std::vector<std::uint32_t>{0, 0, 0, 0, 4, 4, 4, 4}));
}

}  // namespace
}  // namespace tactus
