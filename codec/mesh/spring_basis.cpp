// SPDX-License-Identifier: Apache-2.0
#include <tactus/mesh/basis.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <tactus/mesh/graph.h>
#include <tactus/mesh/kriging.h>

static_assert(FLT_EVAL_METHOD == 0, "both ends compute the same bits only if no operation has more");

namespace tactus {

// ==== spring network ====

namespace {

constexpr std::size_t kAxes = 3;
constexpr double kIsotropic = 0x1p-8;  // of a spring's stiffness along its direction

using Pair = std::uint64_t;  // of order indices, the smaller first

/// Each member and the nearest others at other positions.
std::vector<Pair> near_pairs(std::span<const Vec3i> rest, std::span<const std::uint32_t> members) {
  const RestDistance distance(rest);
  std::vector<Pair> out;
  std::vector<std::uint64_t> near;  // distance, then order index
  for (std::uint64_t i = 0; i < members.size(); ++i) {
    near.clear();
    for (std::uint64_t k = 0; k < members.size(); ++k)
      if (rest[members[k]] != rest[members[i]]) near.push_back(distance(rest[members[i]], rest[members[k]]) << 20 | k);
    const std::size_t count = std::min(near.size(), SpringNetwork::kNear);
    std::nth_element(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
    for (std::size_t n = 0; n < count; ++n) {
      const std::uint64_t k = near[n] & 0xfffff;
      out.push_back(std::min(i, k) << 32 | std::max(i, k));
    }
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace

SpringNetwork::SpringNetwork(std::span<const Vec3i> rest, std::span<const std::uint32_t> members,
                             std::span<const std::uint8_t> free) {
  for (const Pair pair : near_pairs(rest, members)) {
    const std::array<std::uint32_t, 2> ends{static_cast<std::uint32_t>(pair >> 32), static_cast<std::uint32_t>(pair)};
    std::array<double, 3> n{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      n[axis] = static_cast<double>(std::int64_t{rest[members[ends[1]]][axis]} - rest[members[ends[0]]][axis]);
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (double& c : n) c /= length;
    springs_.push_back({ends, n});
  }
  for (std::uint32_t i = 0; i < free.size(); ++i)
    if (!free[i]) fixed_.push_back(i);
  find_bound(members.size());
}

/// Twice the largest Frobenius norm of a diagonal block of K.
void SpringNetwork::find_bound(std::size_t members) {
  std::vector<std::array<double, 9>> blocks(members);
  for (const Spring& s : springs_)
    for (const std::uint32_t end : s.ends)
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k)
          blocks[end][3 * i + k] += s.direction[i] * s.direction[k] + (i == k ? kIsotropic : 0.0);
  for (const auto& block : blocks) {
    double square = 0;
    for (const double c : block) square += c * c;
    bound_ = std::max(bound_, 2 * std::sqrt(square));
  }
}

void SpringNetwork::multiply(const Columns& x, Columns& out) const noexcept {
  constexpr std::size_t kLanes = Columns::kLanes;
  std::fill(out.values.begin(), out.values.end(), 0.0);
  for (const Spring& s : springs_) {
    const auto& n = s.direction;
    const double *a = x.row(kAxes * s.ends[0]), *b = x.row(kAxes * s.ends[1]);
    double *to_a = out.row(kAxes * s.ends[0]), *to_b = out.row(kAxes * s.ends[1]);
    for (std::size_t c = 0; c < x.stride; c += kLanes) {
      std::array<std::array<double, kLanes>, 3> d;
      std::array<double, kLanes> along;
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::size_t l = 0; l < kLanes; ++l) d[axis][l] = a[axis * x.stride + c + l] - b[axis * x.stride + c + l];
      for (std::size_t l = 0; l < kLanes; ++l) along[l] = n[0] * d[0][l] + n[1] * d[1][l] + n[2] * d[2][l];
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::size_t l = 0; l < kLanes; ++l) d[axis][l] = n[axis] * along[l] + kIsotropic * d[axis][l];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (std::size_t l = 0; l < kLanes; ++l) to_a[axis * x.stride + c + l] += d[axis][l];
        for (std::size_t l = 0; l < kLanes; ++l) to_b[axis * x.stride + c + l] -= d[axis][l];
      }
    }
  }
  for (const std::uint32_t i : fixed_) std::fill(out.row(kAxes * i), out.row(kAxes * i + kAxes), 0.0);
}

// ==== ritz ====

namespace {

class Square {
 public:
  explicit Square(std::size_t size) : size_(size), values_(size * size) {}
  double* operator[](std::size_t i) noexcept { return values_.data() + i * size_; }
  const double* operator[](std::size_t i) const noexcept { return values_.data() + i * size_; }
  std::size_t size() const noexcept { return size_; }

 private:
  std::size_t size_;
  std::vector<double> values_;
};

constexpr double kLeastPivot = 0x1p-40;  // of the diagonal: columns that depend on those before them do no harm
constexpr double kLeastSquare = 0x1p-200;
constexpr int kSweeps = 4;

/// The lower triangle of x^T y.
Square product_of(const Columns& x, const Columns& y) {
  Square out(x.columns);
  for (std::size_t r = 0; r < x.rows; ++r) {
    const double *a = x.row(r), *b = y.row(r);
    for (std::size_t i = 0; i < x.columns; ++i)
      for (std::size_t k = 0; k <= i; ++k) out[i][k] += a[i] * b[k];
  }
  return out;
}

/// The inverse of L in L L^T = gram, both lower triangles.
Square inverse_factor(Square l) {
  const std::size_t n = l.size();
  for (std::size_t j = 0; j < n; ++j) {
    double pivot = l[j][j];
    for (std::size_t k = 0; k < j; ++k) pivot -= l[j][k] * l[j][k];
    l[j][j] = std::sqrt(std::max(std::max(pivot, kLeastPivot * l[j][j]), kLeastSquare));
    for (std::size_t i = j + 1; i < n; ++i) {
      for (std::size_t k = 0; k < j; ++k) l[i][j] -= l[i][k] * l[j][k];
      l[i][j] /= l[j][j];
    }
  }
  Square out(n);
  for (std::size_t j = 0; j < n; ++j) {
    out[j][j] = 1 / l[j][j];
    for (std::size_t i = j + 1; i < n; ++i) {
      for (std::size_t k = j; k < i; ++k) out[i][j] -= l[i][k] * out[k][j];
      out[i][j] /= l[i][i];
    }
  }
  return out;
}

/// m a m^T of a lower triangle m and a symmetric a, of which the lower triangle is given.
Square congruent(const Square& m, const Square& a) {
  const std::size_t n = m.size();
  Square half(n), out(n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k <= i; ++k)
      for (std::size_t j = 0; j < n; ++j) half[i][j] += m[i][k] * (j <= k ? a[k][j] : a[j][k]);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      for (std::size_t k = 0; k <= j; ++k) out[i][j] += half[i][k] * m[j][k];
      out[j][i] = out[i][j];
    }
  }
  return out;
}

/// Rotate the rows p and q of m by the angle of cosine c and sine s.
void rotate_rows(Square& m, std::size_t p, std::size_t q, double c, double s) noexcept {
  for (std::size_t k = 0; k < m.size(); ++k) {
    const double x = m[p][k], y = m[q][k];
    m[p][k] = c * x - s * y;
    m[q][k] = s * x + c * y;
  }
}

/// Jacobi's method by rows: a becomes nearly diagonal, and the rows of `rotation` take part.
void diagonalise(Square& a, Square& rotation) noexcept {
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t p = 0; p + 1 < a.size(); ++p) {
      for (std::size_t q = p + 1; q < a.size(); ++q) {
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = (theta < 0 ? -1.0 : 1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        rotate_rows(a, p, q, c, s);
        for (std::size_t k = 0; k < a.size(); ++k) {
          const double x = a[k][p], y = a[k][q];
          a[k][p] = c * x - s * y;
          a[k][q] = s * x + c * y;
        }
        rotate_rows(rotation, p, q, c, s);
      }
    }
  }
}

}  // namespace

std::vector<double> rotate_to_ritz_vectors(Columns& x, const Columns& product) {
  const std::size_t n = x.columns;
  Square combination = inverse_factor(product_of(x, x));
  Square a = congruent(combination, product_of(x, product));
  diagonalise(a, combination);
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t i, std::size_t k) { return a[i][i] != a[k][k] ? a[i][i] < a[k][k] : i < k; });
  Square columns(n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < n; ++k) columns[k][i] = combination[order[i]][k];
  std::vector<double> sums(n);
  for (std::size_t r = 0; r < x.rows; ++r) {
    std::fill(sums.begin(), sums.end(), 0.0);
    double* row = x.row(r);
    for (std::size_t k = 0; k < n; ++k)
      for (std::size_t i = 0; i < n; ++i) sums[i] += row[k] * columns[k][i];
    std::copy(sums.begin(), sums.end(), row);
  }
  std::vector<double> values(n);
  for (std::size_t i = 0; i < n; ++i) values[i] = a[order[i]][order[i]];
  return values;
}

// ==== spring basis ====

namespace {

constexpr std::size_t kSpare = 8;  // columns beside the modes: the last ones of a block converge slowly
constexpr int kDegree = 8;
constexpr int kFirstRounds = 8, kRounds = 3;

class Random {
 public:
  /// In -1..1.
  double next() noexcept {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 40) * 0x1p-23 - 1;
  }

 private:
  std::uint64_t state_ = 1;
};

/// Chebyshev polynomial in K of degree kDegree, which is small on low..high: what remains lies below.
void filter(const SpringNetwork& network, double low, double high, Columns& x, Columns& y, Columns& product) noexcept {
  const double half = (high - low) / 2, middle = (high + low) / 2;
  const double first = -half / middle;
  double sigma = first;
  network.multiply(x, product);
  for (std::size_t i = 0; i < x.values.size(); ++i) y.values[i] = (product.values[i] - middle * x.values[i]) * (sigma / half);
  for (int degree = 2; degree <= kDegree; ++degree) {
    const double next = 1 / (2 / first - sigma);
    const double scale = 2 * next / half, before = sigma * next;
    network.multiply(y, product);
    for (std::size_t i = 0; i < x.values.size(); ++i)
      x.values[i] = scale * (product.values[i] - middle * y.values[i]) - before * x.values[i];
    std::swap(x.values, y.values);
    sigma = next;
  }
  std::swap(x.values, y.values);
}

/// Turn the columns of x into Ritz vectors, after so many filters that bring them nearer to the slowest modes.
void relax(const SpringNetwork& network, int rounds, Columns& x) {
  Columns y(x.rows, x.columns), product(x.rows, x.columns);
  const double high = network.bound();
  for (int round = 0;; ++round) {
    network.multiply(x, product);
    const double largest = rotate_to_ritz_vectors(x, product).back();
    if (round == rounds) return;
    filter(network, std::clamp(largest, high / 256, high / 4), high, x, y, product);
  }
}

class Builder {
 public:
  explicit Builder(const DeformableObject& object)
      : object_(object),
        order_(coding_order(object)),
        parents_(weighted_parents(object, order_, 0)),
        order_index_(object.rest.size()),
        free_(object.rest.size(), 1) {
    for (std::uint32_t i = 0; i < order_.order.size(); ++i) order_index_[order_.order[i]] = i;
    for (const std::uint32_t v : object.spring_basis.fixed) free_[order_index_[v]] = 0;
    for (std::uint32_t i = 0; i < free_.size() && anchors_.size() < kBasisAnchors; ++i)
      if (!free_[i]) anchors_.push_back(i);
  }

  ModeBasis build() {
    const std::size_t modes = object_.spring_basis.modes;
    const std::vector<std::size_t> stages = stages_for(modes + kSpare);
    const std::size_t start_free = free_in(stages.front());
    Columns x(3 * stages.front(), std::min(modes + kSpare, 3 * start_free));
    Random random;
    for (std::size_t i = 0; i < stages.front(); ++i)
      for (std::size_t r = 3 * i; free_[i] && r < 3 * i + 3; ++r)
        for (std::size_t c = 0; c < x.columns; ++c) x.row(r)[c] = random.next();
    for (const std::size_t stage : stages) {
      grow(stage, x);
      if (x.columns > 0) relax_stage(stage, stage == stages.front() ? kFirstRounds : kRounds, x);
    }
    return rounded(modes, stages.back(), x);
  }

 private:
  /// How many vertices of the coding order each network takes in: whole depths, each at most half of the next.
  std::vector<std::size_t> stages_for(std::size_t columns) const {
    std::vector<std::size_t> out;
    const std::size_t most = std::min(kBasisCore, order_.order.size());
    for (std::size_t i = most; i > 0 && 3 * free_in(i) >= 2 * columns; --i) {
      const bool whole = i == order_.order.size() || order_.depth[order_.order[i]] != order_.depth[order_.order[i - 1]];
      if (whole && (out.empty() || 2 * i <= out.back())) out.push_back(i);
    }
    if (out.empty()) out.push_back(most);
    std::reverse(out.begin(), out.end());
    return out;
  }
  std::size_t free_in(std::size_t count) const noexcept {
    return static_cast<std::size_t>(std::count(free_.begin(), free_.begin() + static_cast<std::ptrdiff_t>(count), 1));
  }
  std::vector<std::uint32_t> members_of(std::size_t stage) const {
    std::vector<std::uint32_t> out(order_.order.begin(), order_.order.begin() + static_cast<std::ptrdiff_t>(stage));
    for (const std::uint32_t i : anchors_)
      if (i >= stage) out.push_back(order_.order[i]);
    return out;
  }

  template <class Row>
  void from_parents(std::size_t i, Row row) const {
    if (!free_[i]) return;
    for (const VertexParent& p : parents_[i]) row(order_index_[p.vertex], p.weight * 0x1p-15);
  }

  void grow(std::size_t stage, Columns& x) const {
    Columns grown(3 * stage, x.columns);
    std::copy(x.values.begin(), x.values.end(), grown.values.begin());
    for (std::size_t i = x.rows / 3; i < stage; ++i) {
      from_parents(i, [&](std::uint32_t parent, double weight) {
        for (std::size_t axis = 0; axis < 3; ++axis)
          for (std::size_t c = 0; c < x.columns; ++c)
            grown.row(kAxes * i + axis)[c] += weight * grown.row(kAxes * parent + axis)[c];
      });
    }
    x = std::move(grown);
  }

  void relax_stage(std::size_t stage, int rounds, Columns& x) const {
    const std::vector<std::uint32_t> members = members_of(stage);
    std::vector<std::uint8_t> free(free_.begin(), free_.begin() + static_cast<std::ptrdiff_t>(stage));
    free.resize(members.size(), 0);
    const SpringNetwork network(object_.rest, members, free);
    Columns all(3 * members.size(), x.columns);
    std::copy(x.values.begin(), x.values.end(), all.values.begin());
    relax(network, rounds, all);
    std::copy(all.values.begin(), all.values.begin() + static_cast<std::ptrdiff_t>(x.values.size()), x.values.begin());
  }

  ModeBasis rounded(std::size_t modes, std::size_t stage, const Columns& x) const {
    ModeBasis out;
    out.entries.reserve(modes * 3 * order_.order.size());
    std::vector<double> mode(3 * order_.order.size());
    for (std::size_t k = 0; k < modes; ++k) {
      std::fill(mode.begin(), mode.end(), 0.0);
      for (std::size_t i = 0; i < order_.order.size(); ++i) {
        double* at = mode.data() + kAxes * order_.order[i];
        if (i < stage) {
          for (std::size_t axis = 0; axis < 3 && k < x.columns; ++axis) at[axis] = x.row(3 * i + axis)[k];
          continue;
        }
        from_parents(i, [&](std::uint32_t parent, double weight) {
          for (std::size_t axis = 0; axis < 3; ++axis) at[axis] += weight * mode[kAxes * order_.order[parent] + axis];
        });
      }
      append_mode(out, mode);
    }
    return out;
  }

  const DeformableObject& object_;
  CodingOrder order_;
  ListOfLists<VertexParent> parents_;
  std::vector<std::uint32_t> order_index_;  // by vertex, in the order
  std::vector<std::uint8_t> free_;          // by order index
  std::vector<std::uint32_t> anchors_;      // order indices
};

}  // namespace

ModeBasis spring_basis(const DeformableObject& object) { return Builder(object).build(); }

}  // namespace tactus
