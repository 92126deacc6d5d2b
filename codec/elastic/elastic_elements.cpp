// SPDX-License-Identifier: Apache-2.0
#include <tactus/elastic/elastic_elements.h>

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

constexpr int kElementSteps = 6, kVertexSteps = 4;

/// R = (R + cofactors(R) / det R) / 2
template <class Number>
void newton_step(std::array<Number, 9>& r, std::size_t lane) noexcept {
  const auto at = [&](std::size_t i) -> double& {
    if constexpr (std::is_same_v<Number, double>) return r[i];
    else return r[i][lane];
  };
  const std::array<double, 9> c{at(4) * at(8) - at(5) * at(7), at(5) * at(6) - at(3) * at(8), at(3) * at(7) - at(4) * at(6),
                                at(2) * at(7) - at(1) * at(8), at(0) * at(8) - at(2) * at(6), at(1) * at(6) - at(0) * at(7),
                                at(1) * at(5) - at(2) * at(4), at(2) * at(3) - at(0) * at(5), at(0) * at(4) - at(1) * at(3)};
  const double half = 0.5 / (at(0) * c[0] + at(1) * c[1] + at(2) * c[2]);
  for (std::size_t i = 0; i < 9; ++i) at(i) = 0.5 * at(i) + half * c[i];
}

}  // namespace

Rotation nearest_rotation(const Rotation& of, int steps) noexcept {
  Rotation r = of;
  for (int i = 0; i < steps; ++i) newton_step(r, 0);
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
  block.rotation = gradient;
  for (int i = 0; i < kElementSteps; ++i)
    for (std::size_t l = 0; l < kLanes; ++l) newton_step(block.rotation, l);
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

}  // namespace tactus
