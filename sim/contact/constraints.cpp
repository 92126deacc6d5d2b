// SPDX-License-Identifier: Apache-2.0
#include <tactus/sim/contact/constraints.h>

#include <algorithm>
#include <numeric>

namespace tactus::sim {
namespace {

constexpr double kParallel = 1e-14;  // squared sine, or squared volume, below which normals count as dependent

class Search {
 public:
  Search(std::span<const Halfspace> planes, const Vec3& goal, double slack) : planes_(planes), goal_(goal), slack_(slack) {
    for (std::size_t i = 0; i < planes.size(); ++i) missing_[i] = planes[i].offset - dot(planes[i].normal, goal);
  }

  std::optional<Constrained> none() const { return accepted({goal_, {}}); }

  std::optional<Constrained> one(std::size_t i) const {
    if (missing_[i] < 0) return std::nullopt;
    Constrained out{goal_ + missing_[i] * n(i), {}};
    out.lambda[i] = missing_[i];
    return accepted(out);
  }

  std::optional<Constrained> two(std::size_t i, std::size_t j) const {
    const Vec3 axis = cross(n(i), n(j));
    const double sine2 = dot(axis, axis), cosine = dot(n(i), n(j));
    if (sine2 < kParallel) return std::nullopt;
    Constrained out;
    out.lambda[i] = (missing_[i] - cosine * missing_[j]) / sine2;
    out.lambda[j] = (missing_[j] - cosine * missing_[i]) / sine2;
    out.point = goal_ + (out.lambda[i] * n(i) + out.lambda[j] * n(j));
    return accepted(out);
  }

  std::optional<Constrained> three(std::size_t i, std::size_t j, std::size_t k) const {
    const Vec3 a = cross(n(j), n(k)), b = cross(n(k), n(i)), c = cross(n(i), n(j));
    const double volume = dot(n(i), a);
    if (volume * volume < kParallel) return std::nullopt;
    const Vec3 way = (1 / volume) * (missing_[i] * a + missing_[j] * b + missing_[k] * c);
    Constrained out{goal_ + way, {}};
    out.lambda[i] = dot(way, a) / volume;
    out.lambda[j] = dot(way, b) / volume;
    out.lambda[k] = dot(way, c) / volume;
    return accepted(out);
  }

 private:
  const Vec3& n(std::size_t i) const { return planes_[i].normal; }

  std::optional<Constrained> accepted(const Constrained& candidate) const {
    if (std::any_of(candidate.lambda.begin(), candidate.lambda.end(), [](double l) { return l < 0; })) return std::nullopt;
    for (const Halfspace& plane : planes_)
      if (dot(plane.normal, candidate.point) < plane.offset - slack_) return std::nullopt;
    return candidate;
  }

  std::span<const Halfspace> planes_;
  Vec3 goal_;
  double slack_;
  std::array<double, kMaxHalfspaces> missing_{};  // how far the goal lies below each plane
};

}  // namespace

double Constrained::sum() const noexcept { return std::accumulate(lambda.begin(), lambda.end(), 0.0); }

std::optional<Constrained> nearest_within(std::span<const Halfspace> planes, const Vec3& goal, double slack) noexcept {
  const Search search(planes, goal, slack);
  if (const auto found = search.none()) return found;
  for (std::size_t i = 0; i < planes.size(); ++i)
    if (const auto found = search.one(i)) return found;
  for (std::size_t i = 0; i < planes.size(); ++i)
    for (std::size_t j = i + 1; j < planes.size(); ++j)
      if (const auto found = search.two(i, j)) return found;
  for (std::size_t i = 0; i < planes.size(); ++i)
    for (std::size_t j = i + 1; j < planes.size(); ++j)
      for (std::size_t k = j + 1; k < planes.size(); ++k)
        if (const auto found = search.three(i, j, k)) return found;
  return std::nullopt;
}

}  // namespace tactus::sim
