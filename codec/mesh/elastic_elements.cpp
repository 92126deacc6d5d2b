// SPDX-License-Identifier: Apache-2.0
#include <tactus/mesh/elastic_elements.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include <tactus/base/fixed.h>
#include <tactus/base/tri_mesh.h>

namespace tactus {

std::vector<Vec3> elastic_rest(const DeformableObject& object, unsigned position_exp) {
  const double unit = std::ldexp(1.0, -static_cast<int>(position_exp));
  std::vector<Vec3> out;
  out.reserve(object.rest.size() + object.body->inner.size());
  for (const auto* list : {&object.rest, &object.body->inner})
    for (const Vec3i& p : *list) out.push_back({unit * p[0], unit * p[1], unit * p[2]});
  return out;
}

// ==== elimination ====

namespace {

/// For each free vertex the other free ones that share a tetrahedron with it, ascending.
ListOfLists<std::uint32_t> neighbours(const ElasticBody& body, const std::vector<std::uint8_t>& is_free) {
  std::vector<std::uint64_t> pairs;
  for (const ElasticBody::Tet& tet : body.tets)
    for (const std::uint32_t a : tet)
      for (const std::uint32_t b : tet)
        if (a != b && is_free[a] != 0 && is_free[b] != 0) pairs.push_back(std::uint64_t{a} << 32 | b);
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  ListOfLists<std::uint32_t> out;
  out.items.reserve(pairs.size());
  auto pair = pairs.begin();
  for (std::uint64_t v = 0; v < is_free.size(); ++v) {
    for (; pair != pairs.end() && *pair >> 32 == v; ++pair) out.items.push_back(static_cast<std::uint32_t>(*pair));
    out.close();
  }
  return out;
}

/// Breadth first, those with few neighbours first.
class Walk {
 public:
  Walk(const ListOfLists<std::uint32_t>& near, std::size_t vertices) : near_(near), seen_in_(vertices, 0) {}

  /// All that is connected with `start`, which comes first.
  void from(std::uint32_t start, std::vector<std::uint32_t>& out) {
    ++walks_;
    out.assign(1, start);
    seen_in_[start] = walks_;
    for (std::size_t i = 0; i < out.size(); ++i) {
      const std::size_t found = out.size();
      for (const std::uint32_t v : near_[out[i]]) {
        if (seen_in_[v] == walks_) continue;
        seen_in_[v] = walks_;
        out.push_back(v);
      }
      const auto key = [this](std::uint32_t v) { return std::pair(near_[v].size(), v); };
      std::ranges::sort(out.begin() + static_cast<std::ptrdiff_t>(found), out.end(), {}, key);
    }
  }

 private:
  const ListOfLists<std::uint32_t>& near_;
  std::vector<std::uint32_t> seen_in_;  // number of a walk
  std::uint32_t walks_ = 0;
};

}  // namespace

Elimination elimination(const ElasticBody& body, std::size_t vertices) {
  std::vector<std::uint8_t> is_free(vertices, 1);
  for (const std::uint32_t v : body.fixed) is_free[v] = 0;
  const ListOfLists<std::uint32_t> near = neighbours(body, is_free);
  Elimination out{.order = {}, .order_index = std::vector<std::uint32_t>(vertices, Elimination::kFixed), .first = {}};
  Walk walk(near, vertices);
  std::vector<std::uint32_t> part;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    if (is_free[v] == 0 || out.order_index[v] != Elimination::kFixed) continue;
    walk.from(v, part);
    walk.from(part.back(), part);
    for (const std::uint32_t w : part) out.order_index[w] = 0;
    out.order.insert(out.order.end(), part.begin(), part.end());
  }
  std::ranges::reverse(out.order);
  for (std::uint32_t i = 0; i < out.order.size(); ++i) out.order_index[out.order[i]] = i;
  out.first.resize(out.order.size());
  for (std::uint32_t i = 0; i < out.order.size(); ++i) {
    out.first[i] = i;
    for (const std::uint32_t v : near[out.order[i]]) out.first[i] = std::min(out.first[i], out.order_index[v]);
  }
  return out;
}

std::uint64_t elastic_work(const Elimination& elimination) noexcept {
  constexpr std::uint64_t kLargest = std::uint64_t{1} << 54;
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < elimination.first.size(); ++i) {
    for (std::uint64_t axis = 0; axis < 3; ++axis) {
      const std::uint64_t width = 3 * (i - elimination.first[i]) + axis;
      sum = std::min(sum + (width + 64) * (width + 64), kLargest);
    }
  }
  return sum;
}

std::uint64_t elastic_work(const ElasticBody& body, std::size_t vertices) {
  if (body.method != ElasticBody::Method::velocity_verlet) return elastic_work(elimination(body, vertices));
  return 128 * (body.sub_steps + std::uint64_t{kStabilitySteps}) * body.tets.size();
}

// ==== elastic elements ====

namespace {

constexpr int kElementSteps = 6, kVertexSteps = 4, kScaledSteps = 4, kSquarings = 5;
constexpr double kThin = 0.125;  // of its volume: below, Newton's method needs scaled steps

/// Of a matrix whose entry i is at(i).
template <class At>
Rotation cofactors(const At& at) noexcept {
  return {at(4) * at(8) - at(5) * at(7), at(5) * at(6) - at(3) * at(8), at(3) * at(7) - at(4) * at(6),
          at(2) * at(7) - at(1) * at(8), at(0) * at(8) - at(2) * at(6), at(1) * at(6) - at(0) * at(7),
          at(1) * at(5) - at(2) * at(4), at(2) * at(3) - at(0) * at(5), at(0) * at(4) - at(1) * at(3)};
}

/// R = (R + cofactors(R) / det R) / 2
template <class At>
void newton_step(const At& at) noexcept {
  const Rotation c = cofactors(at);
  const double half = 0.5 / (at(0) * c[0] + at(1) * c[1] + at(2) * c[2]);
  for (std::size_t i = 0; i < 9; ++i) at(i) = 0.5 * at(i) + half * c[i];
}

/// The same of t R, t = sqrt(|R^-1| / |R|): brings what is thin or long near to a rotation in a few steps.
template <class At>
void scaled_newton_step(const At& at) noexcept {
  const Rotation c = cofactors(at);
  const double det = at(0) * c[0] + at(1) * c[1] + at(2) * c[2];
  double own = 0, other = 0;
  for (std::size_t i = 0; i < 9; ++i) {
    own += at(i) * at(i);
    other += c[i] * c[i];
  }
  const double scale = std::sqrt(std::sqrt(other / (own * (det * det))));
  const double half = 0.5 * scale, inverse = 0.5 / (scale * det);
  for (std::size_t i = 0; i < 9; ++i) at(i) = half * at(i) + inverse * c[i];
}

/// Turn an orthogonal matrix that mirrors, the nearest one to M, over along the direction in which M is thinnest. That is the eigenvector
/// of the largest eigenvalue of the cofactors of R^T M, by powers.
void make_proper(const Rotation& M, Rotation& R) noexcept {
  Rotation P;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b) P[3 * a + b] = R[a] * M[b] + R[3 + a] * M[3 + b] + R[6 + a] * M[6 + b];
  Rotation A = cofactors([&](std::size_t i) { return P[i]; });
  for (int i = 0; i < kSquarings; ++i) {
    const double scale = 1 / (A[0] + A[4] + A[8]);
    for (double& x : A) x *= scale;
    Rotation B;
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) B[3 * a + b] = A[3 * a] * A[b] + A[3 * a + 1] * A[3 + b] + A[3 * a + 2] * A[6 + b];
    A = B;
  }
  const std::size_t j = A[0] >= A[4] && A[0] >= A[8] ? 0 : A[4] >= A[8] ? 1 : 2;
  const Vec3 thin{A[j], A[3 + j], A[6 + j]};
  const double twice = 2 / dot(thin, thin);
  for (std::size_t a = 0; a < 9; a += 3) {
    const double along = twice * (R[a] * thin.x + R[a + 1] * thin.y + R[a + 2] * thin.z);
    R[a] -= along * thin.x;
    R[a + 1] -= along * thin.y;
    R[a + 2] -= along * thin.z;
  }
}

}  // namespace

Rotation nearest_rotation(const Rotation& of, int steps) noexcept {
  Rotation r = of;
  for (int i = 0; i < steps; ++i) newton_step([&](std::size_t j) -> double& { return r[j]; });
  return r;
}

Rotation element_rotation(const Rotation& of) noexcept {
  const Rotation c = cofactors([&](std::size_t i) { return of[i]; });
  const double det = of[0] * c[0] + of[1] * c[1] + of[2] * c[2];
  Rotation r = of;
  for (int i = 0; det < kThin && i < kScaledSteps; ++i) scaled_newton_step([&](std::size_t j) -> double& { return r[j]; });
  r = nearest_rotation(r, kElementSteps);
  if (det < 0) make_proper(of, r);
  return r;
}

ElasticElements::ElasticElements(const ElasticBody& body, std::span<const Vec3> rest)
    : blocks_((body.tets.size() + kLanes - 1) / kLanes), mass_(rest.size(), 0) {
  for (std::size_t e = 0; e < body.tets.size(); ++e) {
    Block& block = blocks_[e / kLanes];
    const std::size_t lane = e % kLanes;
    const ElasticBody::Tet& tet = body.tets[e];
    const ElasticMaterial& m = body.materials[body.material[e]];
    const Vec3 x = rest[tet[1]] - rest[tet[0]], y = rest[tet[2]] - rest[tet[0]], z = rest[tet[3]] - rest[tet[0]];
    const std::array<Vec3, 3> across{cross(y, z), cross(z, x), cross(x, y)};
    const double six = dot(across[2], z);
    for (std::size_t r = 0; r < 3; ++r) {
      block.gradient[3 * r][lane] = across[r].x / six;
      block.gradient[3 * r + 1][lane] = across[r].y / six;
      block.gradient[3 * r + 2][lane] = across[r].z / six;
    }
    block.two_mu[lane] = six / 3 * (m.young / (2 * (1 + m.poisson)));
    block.lambda[lane] = six / 6 * (m.young * m.poisson / ((1 + m.poisson) * (1 - 2 * m.poisson)));
    for (std::size_t r = 0; r < 4; ++r) {
      block.corner[r][lane] = 3 * tet[r];
      mass_[tet[r]] += m.density * six / 24;
    }
    for (std::size_t i = 0; i < 9; i += 4) block.rotation[i][lane] = 1;
    block.count = lane + 1;
  }
}

/// F, or what F gains.
template <ElasticElements::Of of>
void ElasticElements::gather(const Block& block, std::span<const double> u, std::array<Lanes, 9>& gradient) noexcept {
  for (std::size_t i = 0; i < 9; ++i) gradient[i].fill(of == Of::shape && i % 4 == 0 ? 1 : 0);
  for (std::size_t r = 1; r < 4; ++r) {
    for (std::size_t a = 0; a < 3; ++a) {
      Lanes d;
      for (std::size_t l = 0; l < kLanes; ++l) d[l] = u[block.corner[r][l] + a] - u[block.corner[0][l] + a];
      for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t l = 0; l < kLanes; ++l) gradient[3 * a + c][l] += d[l] * block.gradient[3 * (r - 1) + c][l];
    }
  }
}

void ElasticElements::turn(Block& block, const std::array<Lanes, 9>& gradient) noexcept {
  bool is_thin = false;
  for (std::size_t l = 0; l < kLanes; ++l) {
    const auto g = [&](std::size_t i) { return gradient[i][l]; };
    const Rotation c = cofactors(g);
    is_thin |= g(0) * c[0] + g(1) * c[1] + g(2) * c[2] < kThin;
  }
  block.rotation = gradient;
  if (!is_thin) {
    for (int i = 0; i < kElementSteps; ++i)
      for (std::size_t l = 0; l < kLanes; ++l) newton_step([&](std::size_t j) -> double& { return block.rotation[j][l]; });
    return;
  }
  for (std::size_t l = 0; l < kLanes; ++l) {
    Rotation of;
    for (std::size_t i = 0; i < 9; ++i) of[i] = gradient[i][l];
    const Rotation r = element_rotation(of);
    for (std::size_t i = 0; i < 9; ++i) block.rotation[i][l] = r[i];
  }
}

template <ElasticElements::Of of>
void ElasticElements::add_forces(const Block& block, const std::array<Lanes, 9>& gradient, std::span<double> k) noexcept {
  constexpr double kRest = of == Of::shape ? 1 : 0;
  std::array<Lanes, 9> force;
  const auto& R = block.rotation;
  for (std::size_t l = 0; l < kLanes; ++l) {
    std::array<double, 9> s;
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t c = 0; c < 3; ++c)
        s[3 * a + c] = R[a][l] * gradient[c][l] + R[3 + a][l] * gradient[3 + c][l] + R[6 + a][l] * gradient[6 + c][l];
    const double x = s[0] - kRest, y = s[4] - kRest, z = s[8] - kRest, mu = block.two_mu[l];
    const double all = block.lambda[l] * (x + y + z);
    const double xy = 0.5 * mu * (s[1] + s[3]), xz = 0.5 * mu * (s[2] + s[6]), yz = 0.5 * mu * (s[5] + s[7]);
    const std::array<double, 9> stress{mu * x + all, xy, xz, xy, mu * y + all, yz, xz, yz, mu * z + all};
    for (std::size_t a = 0; a < 3; ++a) {
      std::array<double, 3> p;
      for (std::size_t c = 0; c < 3; ++c)
        p[c] = R[3 * a][l] * stress[c] + R[3 * a + 1][l] * stress[3 + c] + R[3 * a + 2][l] * stress[6 + c];
      for (std::size_t r = 0; r < 3; ++r)
        force[3 * r + a][l] =
            p[0] * block.gradient[3 * r][l] + p[1] * block.gradient[3 * r + 1][l] + p[2] * block.gradient[3 * r + 2][l];
    }
  }
  for (std::size_t l = 0; l < block.count; ++l) {
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t a = 0; a < 3; ++a) {
        k[block.corner[r + 1][l] + a] += force[3 * r + a][l];
        k[block.corner[0][l] + a] -= force[3 * r + a][l];
      }
    }
  }
}

void ElasticElements::forces(std::span<const double> u, std::span<double> k) noexcept {
  std::ranges::fill(k, 0);
  std::array<Lanes, 9> gradient;
  for (Block& block : blocks_) {
    gather<Of::shape>(block, u, gradient);
    turn(block, gradient);
    add_forces<Of::shape>(block, gradient, k);
  }
}

void ElasticElements::multiply(std::span<const double> p, std::span<double> k) noexcept {
  std::ranges::fill(k, 0);
  std::array<Lanes, 9> gradient;
  for (const Block& block : blocks_) {
    gather<Of::increment>(block, p, gradient);
    add_forces<Of::increment>(block, gradient, k);
  }
}

void ElasticElements::vertex_rotations(std::span<Rotation> out) const noexcept {
  std::ranges::fill(out, Rotation{});
  for (const Block& block : blocks_)
    for (std::size_t l = 0; l < block.count; ++l)
      for (std::size_t r = 0; r < 4; ++r)
        for (std::size_t i = 0; i < 9; ++i) out[block.corner[r][l] / 3][i] += block.rotation[i][l] * block.two_mu[l];
  for (Rotation& rotation : out) {
    double square = 0;
    for (const double x : rotation) square += x * x;
    const double scale = std::sqrt(3 / square);
    for (double& x : rotation) x *= scale;
    rotation = nearest_rotation(rotation, kVertexSteps);
  }
}

Rotation ElasticElements::stiffness(std::size_t element, std::size_t row, std::size_t column) const noexcept {
  const Block& block = blocks_[element / kLanes];
  const std::size_t l = element % kLanes;
  const auto gradient = [&](std::size_t corner, std::size_t axis) {
    if (corner > 0) return block.gradient[3 * (corner - 1) + axis][l];
    return -(block.gradient[axis][l] + block.gradient[3 + axis][l] + block.gradient[6 + axis][l]);
  };
  const double mu = 0.5 * block.two_mu[l];
  const double along =
      gradient(row, 0) * gradient(column, 0) + gradient(row, 1) * gradient(column, 1) + gradient(row, 2) * gradient(column, 2);
  Rotation out;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t c = 0; c < 3; ++c)
      out[3 * a + c] = block.lambda[l] * gradient(row, a) * gradient(column, c) + mu * gradient(row, c) * gradient(column, a) +
                       (a == c ? mu * along : 0);
  return out;
}

bool is_stable(const ElasticBody& body, std::span<const Vec3> rest, double step) {
  if (body.method != ElasticBody::Method::velocity_verlet) return true;
  ElasticElements elements(body, rest);
  std::vector<std::uint8_t> is_free(rest.size(), 1);
  for (const std::uint32_t v : body.fixed) is_free[v] = 0;
  std::vector<double> x(3 * rest.size(), 0), k(x.size());
  std::uint32_t seed = 1;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (is_free[i / 3] == 0) continue;
    seed = seed * 1664525 + 1013904223;
    x[i] = std::ldexp(seed, -32) - 0.5;
  }
  constexpr double kMost = 3.61;  // of 4
  double square = 0;              // [s^-2] of the highest frequency at rest, from below
  for (int power = 0; power < kStabilitySteps; ++power) {
    elements.multiply(x, k);
    double before = 0, after = 0;
    for (std::size_t v = 0; v < rest.size(); ++v) {
      if (is_free[v] == 0) continue;
      const double mass = elements.mass()[v];
      const double* p = x.data() + 3 * v;
      double* q = k.data() + 3 * v;
      for (std::size_t a = 0; a < 3; ++a) q[a] /= mass;
      before += mass * (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
      after += mass * (q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    }
    square = std::sqrt(after / before);
    const double size = std::sqrt(after);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = is_free[i / 3] == 0 ? 0 : k[i] / size;
  }
  const double part = step / body.sub_steps;
  return part * (part + 2 * body.stiffness_damping) * square <= kMost;
}

// ==== elastic matrix ====

ElasticMatrix::ElasticMatrix(const ElasticBody& body, const Elimination& elimination, const ElasticElements& elements,
                             double mass_factor, double stiffness_factor) {
  std::size_t numbers = 0;
  for (std::size_t i = 0; i < 3 * elimination.order.size(); ++i) {
    first_.push_back(3 * std::size_t{elimination.first[i / 3]});
    start_.push_back(numbers);
    numbers += i - first_.back();
  }
  lower_.resize(numbers);
  diagonal_.resize(first_.size());
  add(body, elimination, elements, stiffness_factor);
  for (std::size_t i = 0; i < diagonal_.size(); ++i) diagonal_[i] += mass_factor * elements.mass()[elimination.order[i / 3]];
  factor();
}

void ElasticMatrix::add(const ElasticBody& body, const Elimination& elimination, const ElasticElements& elements,
                        double factor) noexcept {
  for (std::size_t e = 0; e < body.tets.size(); ++e) {
    for (std::size_t r = 0; r < 4; ++r) {
      for (std::size_t q = 0; q < 4; ++q) {
        const std::uint32_t i = elimination.order_index[body.tets[e][r]], j = elimination.order_index[body.tets[e][q]];
        if (i == Elimination::kFixed || j == Elimination::kFixed || j > i) continue;
        const Rotation k = elements.stiffness(e, r, q);
        for (std::size_t a = 0; a < 3; ++a) {
          const std::size_t at = 3 * std::size_t{i} + a;
          for (std::size_t c = 0; c < 3 && 3 * std::size_t{j} + c <= at; ++c) {
            const std::size_t column = 3 * std::size_t{j} + c;
            (column == at ? diagonal_[at] : row(at)[column - first_[at]]) += factor * k[3 * a + c];
          }
        }
      }
    }
  }
}

void ElasticMatrix::factor() noexcept {
  for (std::size_t i = 0; i < diagonal_.size(); ++i) {
    double* own = row(i);
    for (std::size_t j = first_[i]; j < i; ++j) {
      const double* other = row(j);
      double sum = own[j - first_[i]];
      for (std::size_t k = std::max(first_[i], first_[j]); k < j; ++k) sum -= own[k - first_[i]] * other[k - first_[j]];
      own[j - first_[i]] = sum;
    }
    for (std::size_t j = first_[i]; j < i; ++j) {
      double& entry = own[j - first_[i]];
      const double before = entry;
      entry = before / diagonal_[j];
      diagonal_[i] -= before * entry;
    }
  }
}

void ElasticMatrix::solve(std::span<double> b) const noexcept {
  for (std::size_t i = 0; i < b.size(); i += 3) {  // the rows of a vertex begin alike
    const std::size_t from = first_[i];
    const std::array<const double*, 3> rows{row(i), row(i + 1), row(i + 2)};
    std::array<double, 3> sum{b[i], b[i + 1], b[i + 2]};
    for (std::size_t j = from; j < i; ++j)
      for (std::size_t a = 0; a < 3; ++a) sum[a] -= rows[a][j - from] * b[j];
    b[i] = sum[0];
    b[i + 1] = sum[1] - rows[1][i - from] * b[i];
    b[i + 2] = sum[2] - rows[2][i - from] * b[i] - rows[2][i + 1 - from] * b[i + 1];
  }
  for (std::size_t i = 0; i < b.size(); ++i) b[i] /= diagonal_[i];
  for (std::size_t i = b.size(); i > 0;) {
    i -= 3;
    const std::size_t width = i - first_[i];
    const double *x = row(i), *y = row(i + 1), *z = row(i + 2);
    const double at_z = b[i + 2];
    const double at_y = b[i + 1] -= z[width + 1] * at_z;
    const double at_x = b[i] = b[i] - z[width] * at_z - y[width] * at_y;
    double* out = b.data() + first_[i];
    for (std::size_t j = 0; j < width; ++j) out[j] = out[j] - z[j] * at_z - y[j] * at_y - x[j] * at_x;
  }
}

}  // namespace tactus
