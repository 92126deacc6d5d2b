// SPDX-License-Identifier: Apache-2.0
#include <tactus/mesh/kriging.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <type_traits>

#include <tactus/base/fixed.h>
#include <tactus/mesh/graph.h>

namespace tactus {
namespace {

constexpr std::size_t kMost = VertexHierarchy::kParents;
using Row = std::array<std::int64_t, kMost>;

constexpr std::int64_t kOne = 1 << 24;
constexpr std::int64_t kLeastPivot = 1 << 18;
constexpr std::int64_t kMostFraction = std::int64_t{1} << 34;
constexpr std::array<std::int64_t, DeformableObject::kWeightSets> kNuggets{
    335544, 838861, 5033165};                 // 0.02, 0.05, 0.3: how much of a parent's movement is its own
constexpr std::uint64_t kSupportRadius = 94;  // squared, in mean squared distances of the parents
constexpr std::int32_t kWhole = 1 << 15;      // weight of an only parent

constexpr std::int64_t bounded(std::int64_t v, std::int64_t limit) noexcept { return std::clamp(v, -limit, limit); }

/// Divides by one number many times.
class Divisor {
 public:
  /// pre  b > 0
  explicit Divisor(std::int64_t b) noexcept : b_(b), inverse_(1.0 / static_cast<double>(b)) {}

  /// floor(a / b).   pre  |a| < 2^62, |a / b| < 2^45: the estimate is then off by less than one
  std::int64_t floor(std::int64_t a) const noexcept {
    const double estimate = static_cast<double>(a) * inverse_;
    std::int64_t q = static_cast<std::int64_t>(estimate) - (estimate < 0 ? 1 : 0);
    const std::int64_t rest = a - q * b_;
    q += rest >= b_ ? 1 : 0;
    return q - (rest < 0 ? 1 : 0);
  }
  /// round_div(a, b)
  std::int64_t round(std::int64_t a) const noexcept { return floor(a + b_ / 2); }

 private:
  std::int64_t b_;
  double inverse_;
};

/// How alike two vertices move, x 2^-24: (1 - r)^4 (1 + 4 r) of r^2 = distance / support radius, 0 beyond.
class Covariance {
 public:
  explicit Covariance(std::uint64_t support_radius) noexcept
      : support_radius_(support_radius), divisor_(static_cast<std::int64_t>(support_radius)) {}

  std::int64_t operator()(std::uint64_t distance) const noexcept {
    if (distance >= support_radius_) return 0;
    const std::int64_t square = divisor_.floor(static_cast<std::int64_t>(distance << 24)) << 24;
    const auto r = static_cast<std::int64_t>(std::sqrt(static_cast<double>(square)));
    const std::int64_t t = ((kOne - r) * (kOne - r)) >> 24;
    return (((t * t) >> 24) * (4 * r + kOne)) >> 24;
  }

 private:
  std::uint64_t support_radius_;
  Divisor divisor_;
};

/// C a = c and C b = 1 of one vertex. Only what `size` says is set.
struct Equations {
  std::size_t size;
  std::array<Row, kMost> matrix;  // lower triangle
  Row a, b;
};

/// Solves for both right sides by L D L^T. False: the matrix is not positive definite, which happens where vertices (nearly)
/// coincide. Otherwise the noise term on the diagonal keeps all pivots large, and no clamp acts: they only keep products within 63
/// bits.
/// in   size  e.size; as a constant it saves a quarter of the time
template <class Size>
bool solve(Equations& e, Size size) noexcept {
  auto& m = e.matrix;
  std::array<Divisor, kMost> pivots{Divisor{1}, Divisor{1}, Divisor{1}, Divisor{1},
                                    Divisor{1}, Divisor{1}, Divisor{1}, Divisor{1}};
  for (std::size_t j = 0; j < size; ++j) {
    if (m[j][j] < kLeastPivot) return false;
    pivots[j] = Divisor(m[j][j]);
    for (std::size_t i = j + 1; i < size; ++i) {
      const std::int64_t factor = bounded(pivots[j].round(m[i][j] << 24), 1 << 28);
      for (std::size_t k = j + 1; k <= i; ++k) m[i][k] = bounded(m[i][k] - round_shift(factor * m[k][j], 24), 1 << 25);
      e.a[i] = bounded(e.a[i] - round_shift(factor * e.a[j], 24), kMostFraction);
      e.b[i] = bounded(e.b[i] - round_shift(factor * e.b[j], 24), kMostFraction);
    }
  }
  for (std::size_t i = size; i-- > 0;) {
    for (std::size_t k = i + 1; k < size; ++k) {
      e.a[i] = bounded(e.a[i] - round_shift(m[k][i] * e.a[k], 24), kMostFraction);
      e.b[i] = bounded(e.b[i] - round_shift(m[k][i] * e.b[k], 24), kMostFraction);
    }
    e.a[i] = bounded(pivots[i].round(e.a[i] << 24), kMostFraction);
    e.b[i] = bounded(pivots[i].round(e.b[i] << 24), kMostFraction);
  }
  return true;
}

/// Weights of best linear prediction whose sum is 1: a + b (1 - sum a) / sum b. Returns how many vertices keep one.
std::size_t weigh(const RestDistance& distance, const Vec3i& at, std::span<const Vec3i> parents, std::int64_t nugget,
                  std::span<std::int32_t, kMost> out) noexcept {
  Equations e;  // not set: 640 bytes for each vertex
  e.size = parents.size();
  std::array<std::uint64_t, kMost> to{};
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < e.size; ++i) sum += to[i] = distance(at, parents[i]);
  const Covariance covariance(kSupportRadius * sum / e.size);
  for (std::size_t i = 0; i < e.size; ++i) {
    for (std::size_t j = 0; j < i; ++j) e.matrix[i][j] = covariance(distance(parents[i], parents[j]));
    e.matrix[i][i] = kOne + nugget;
    e.a[i] = covariance(to[i]);
    e.b[i] = kOne;
  }
  const bool solved = e.size == kMost ? solve(e, std::integral_constant<std::size_t, kMost>()) : solve(e, e.size);
  if (!solved) {
    out[0] = kWhole;
    return 1;
  }
  std::int64_t sum_a = 0, sum_b = 0;
  for (std::size_t i = 0; i < e.size; ++i) {
    sum_a += e.a[i];
    sum_b += e.b[i];
  }
  const Divisor whole(std::max(sum_b, kLeastPivot));
  const std::int64_t rest = bounded(kOne - sum_a, 1 << 26);
  for (std::size_t i = 0; i < e.size; ++i) {
    const std::int64_t fraction = bounded(whole.round(e.b[i] << 24), kMostFraction);
    const std::int64_t weight = round_shift(e.a[i] + round_shift(fraction * rest, 24), 9);
    out[i] = static_cast<std::int32_t>(std::clamp<std::int64_t>(weight, -65536, 65536));
  }
  return e.size;
}

}  // namespace

ListOfLists<VertexParent> weighted_parents(const DeformableObject& object, const CodingOrder& order, unsigned set) {
  const RestDistance distance(object.rest);
  ListOfLists<VertexParent> out;
  out.first.reserve(order.near.first.size());
  out.items.reserve(order.near.items.size());
  std::array<Vec3i, kMost> positions{};
  std::array<std::int32_t, kMost> weights{};
  for (std::size_t i = 0; i < order.order.size(); ++i) {
    const auto near = order.near[i];
    const Vec3i& at = object.rest[order.order[i]];
    for (std::size_t k = 0; k < near.size(); ++k) positions[k] = object.rest[near[k]];
    std::size_t count = near.empty() ? 0 : 1;
    if (count > 0 && positions[0] == at) weights[0] = kWhole;
    else if (count > 0) count = weigh(distance, at, std::span(positions).first(near.size()), kNuggets[set], weights);
    for (std::size_t k = 0; k < count; ++k) out.items.push_back({near[k], weights[k]});
    out.close();
  }
  return out;
}

}  // namespace tactus
