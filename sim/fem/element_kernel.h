// SPDX-License-Identifier: Apache-2.0
/// The element kernel for vectors of W doubles, included by one source file per instruction set. Internal linkage throughout and
/// no function of the standard library, so that no code for one instruction set can serve in place of another's.
/// Symbols as in element.h; matrices are rows, element (i, j) at 3 i + j.
#pragma once

#include "sim/fem/element_block.h"
#include "sim/fem/rotation.h"

namespace tactus {
namespace {

// g++ ignores a vector size that depends on a template parameter.
template <std::size_t W>
struct Vectors;
template <>
struct Vectors<2> {
  using Double [[gnu::vector_size(16)]] = double;
  using Mask [[gnu::vector_size(16)]] = long long;
};
template <>
struct Vectors<4> {
  using Double [[gnu::vector_size(32)]] = double;
  using Mask [[gnu::vector_size(32)]] = long long;
};
template <>
struct Vectors<8> {
  using Double [[gnu::vector_size(64)]] = double;
  using Mask [[gnu::vector_size(64)]] = long long;
};

template <std::size_t W>
struct Kernel {
  using V = typename Vectors<W>::Double;
  using Mask = typename Vectors<W>::Mask;  // -1: true

  struct Matrix {
    V m[9];
  };
  struct Rotation {
    V q[4];  // w x y z
  };

  static V load(const double* p) {
    V v;
    __builtin_memcpy(&v, p, sizeof v);
    return v;
  }
  static void store(double* p, const V& v) { __builtin_memcpy(p, &v, sizeof v); }
  static V all(double x) { return V{} + x; }

  /// u[index[lane] + offset] for every lane; written out because a loop would pass through memory.
  static V gather(const double* u, const std::uint32_t* index) {
    if constexpr (W == 2) {
      return V{u[index[0]], u[index[1]]};
    } else if constexpr (W == 4) {
      return V{u[index[0]], u[index[1]], u[index[2]], u[index[3]]};
    } else {
      return V{u[index[0]], u[index[1]], u[index[2]], u[index[3]], u[index[4]], u[index[5]], u[index[6]], u[index[7]]};
    }
  }

  static bool any(const Mask& mask) {
    long long bits = 0;
    for (std::size_t i = 0; i < W; ++i) bits |= mask[i];
    return bits != 0;
  }

  /// F at u of the elements from `lane` on.
  static Matrix deformation(const ElementBlock& block, std::size_t lane, const double* u) {
    V origin[3], g[9];
    for (std::size_t c = 0; c < 3; ++c) origin[c] = gather(u + c, block.corner[0] + lane);
    for (std::size_t i = 0; i < 9; ++i) g[i] = load(block.gradient[i] + lane);
    Matrix f{};
    for (std::size_t c = 0; c < 3; ++c) {
      V edge[3];
      for (std::size_t r = 0; r < 3; ++r) edge[r] = gather(u + c, block.corner[r + 1] + lane) - origin[c];
      for (std::size_t j = 0; j < 3; ++j) f.m[3 * c + j] = edge[0] * g[j] + edge[1] * g[3 + j] + edge[2] * g[6 + j];
      f.m[4 * c] += 1.0;
    }
    return f;
  }

  /// R(q), orthogonal for q of any length but zero.
  static Matrix matrix(const Rotation& rotation) {
    const V &w = rotation.q[0], &x = rotation.q[1], &y = rotation.q[2], &z = rotation.q[3];
    const V s = 2.0 / (w * w + x * x + y * y + z * z);
    const V sx = s * x, sy = s * y, sz = s * z;
    const V xx = x * sx, xy = x * sy, xz = x * sz, yy = y * sy, yz = y * sz, zz = z * sz, wx = w * sx, wy = w * sy, wz = w * sz;
    return {{1.0 - (yy + zz), xy - wz, xz + wy, xy + wz, 1.0 - (xx + zz), yz - wx, xz - wy, yz + wx, 1.0 - (xx + yy)}};
  }

  /// a^T b
  static Matrix transposed_product(const Matrix& a, const Matrix& b) {
    Matrix out;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j) out.m[3 * i + j] = a.m[i] * b.m[j] + a.m[3 + i] * b.m[3 + j] + a.m[6 + i] * b.m[6 + j];
    return out;
  }

  /// Newton's step on SO(3) for trace(R^T F): (tr(S) I - S) omega = axial(M - M^T), M = R^T F, S = sym(M).
  struct Step {
    V omega[3];
    Mask maximum;  // tr(S) I - S is positive definite: what Newton converges to is the best rotation, not a saddle
  };
  static Step newton_step(const Matrix& m) {
    // Share of its size cubed that the determinant may fall to: below, the rotation hardly follows from F.
    constexpr double kRegular = 1e-9;
    const V a = m.m[4] + m.m[8], b = m.m[0] + m.m[8], c = m.m[0] + m.m[4];
    const V d = -0.5 * (m.m[1] + m.m[3]), e = -0.5 * (m.m[2] + m.m[6]), f = -0.5 * (m.m[5] + m.m[7]);
    const V wx = m.m[7] - m.m[5], wy = m.m[2] - m.m[6], wz = m.m[3] - m.m[1];
    const V aa = b * c - f * f, ad = e * f - d * c, ae = d * f - e * b;  // first row of the adjugate
    const V bb = a * c - e * e, bf = d * e - a * f, cc = a * b - d * d;
    const V det = a * aa + d * ad + e * ae, size = a + b + c, inverse = 1.0 / det;
    return {{(aa * wx + ad * wy + ae * wz) * inverse, (ad * wx + bb * wy + bf * wz) * inverse,
             (ae * wx + bf * wy + cc * wz) * inverse},
            (a > 0.0) & (cc > 0.0) & (size > 0.0) & (det > kRegular * size * size * size)};
  }

  /// Turn R(q) towards the rotation nearest to F.   out  lanes that arrived there
  static Mask refine(const Matrix& f, Rotation& rotation) {
    constexpr int kSteps = 8;
    constexpr double kArrived = 1e-13;  // of |omega|^2: the error left is that times the strain, Newton being quadratic
    Matrix m = transposed_product(matrix(rotation), f);
    Mask open = ~Mask{}, arrived{};
    for (int step = 0; step < kSteps; ++step) {
      const Step newton = newton_step(m);
      open &= newton.maximum;
      // Cayley's map: the quaternion (1, omega / 2). Closed lanes get the identity, which changes no bit of theirs.
      Rotation turn{{all(1.0), open ? 0.5 * newton.omega[0] : all(0.0), open ? 0.5 * newton.omega[1] : all(0.0),
                     open ? 0.5 * newton.omega[2] : all(0.0)}};
      const V *q = rotation.q, *t = turn.q;
      const V square = t[1] * t[1] + t[2] * t[2] + t[3] * t[3];
      rotation = {{q[0] - q[1] * t[1] - q[2] * t[2] - q[3] * t[3], q[1] + q[0] * t[1] + q[2] * t[3] - q[3] * t[2],
                   q[2] + q[0] * t[2] + q[3] * t[1] - q[1] * t[3], q[3] + q[0] * t[3] + q[1] * t[2] - q[2] * t[1]}};
      const Mask last = open & (4.0 * square < kArrived);
      arrived |= last;
      open &= ~last;
      if (!any(open)) break;
      m = transposed_product(matrix(turn), m);
    }
    const V* q = rotation.q;
    const V length2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    const V scale = 2.0 / (1.0 + length2);  // Newton's step for the root: length 1 to second order
    for (V& x : rotation.q) x *= scale;
    return arrived;
  }

  /// What Newton cannot do: inverted, flat and lost elements, one by one.
  static void repair(const Matrix& f, const Rotation& start, const Mask& arrived, Rotation& rotation) {
    for (std::size_t lane = 0; lane < W; ++lane) {
      if (arrived[lane] != 0) continue;
      Matrix3 one;
      for (std::size_t i = 0; i < 9; ++i) one.m[i / 3][i % 3] = f.m[i][lane];
      Quat from;
      from.w = start.q[0][lane], from.x = start.q[1][lane], from.y = start.q[2][lane], from.z = start.q[3][lane];
      const Quat to = nearest_rotation(one, from);
      rotation.q[0][lane] = to.w, rotation.q[1][lane] = to.x, rotation.q[2][lane] = to.y, rotation.q[3][lane] = to.z;
    }
  }

  /// R of the elements from `lane` on, remembered in the block.
  static Matrix rotate(ElementBlock& block, std::size_t lane, const Matrix& f) {
    Rotation start, rotation;
    for (std::size_t i = 0; i < 4; ++i) start.q[i] = load(block.rotation[i] + lane);
    rotation = start;
    const Mask arrived = refine(f, rotation);
    if (any(~arrived)) repair(f, start, arrived, rotation);
    for (std::size_t i = 0; i < 4; ++i) store(block.rotation[i] + lane, rotation.q[i]);
    return matrix(rotation);
  }

  /// Strain e = sym(M) - I.
  struct Strain {
    V xx, yy, zz, yz, xz, xy;
  };
  static Strain strain(const Matrix& m) {
    return {m.m[0] - 1.0, m.m[4] - 1.0, m.m[8] - 1.0, 0.5 * (m.m[5] + m.m[7]), 0.5 * (m.m[2] + m.m[6]), 0.5 * (m.m[1] + m.m[3])};
  }

  /// V (2 mu e + lambda tr(e) I)
  static Matrix stress(const ElementBlock& block, std::size_t lane, const Strain& e) {
    const V two_mu = load(block.two_mu + lane), pressure = load(block.lambda + lane) * (e.xx + e.yy + e.zz);
    const V xy = two_mu * e.xy, xz = two_mu * e.xz, yz = two_mu * e.yz;
    return {{two_mu * e.xx + pressure, xy, xz, xy, two_mu * e.yy + pressure, yz, xz, yz, two_mu * e.zz + pressure}};
  }

  /// k_r = P g_r added to k, element after element.
  static void scatter(const ElementBlock& block, std::size_t lane, const Matrix& p, double* k) {
    alignas(64) double force[12][W];
    V origin[3] = {};
    for (std::size_t r = 0; r < 3; ++r) {
      V g[3];
      for (std::size_t j = 0; j < 3; ++j) g[j] = load(block.gradient[3 * r + j] + lane);
      for (std::size_t c = 0; c < 3; ++c) {
        const V x = p.m[3 * c] * g[0] + p.m[3 * c + 1] * g[1] + p.m[3 * c + 2] * g[2];
        store(force[3 * (r + 1) + c], x);
        origin[c] -= x;
      }
    }
    for (std::size_t c = 0; c < 3; ++c) store(force[c], origin[c]);
    for (std::size_t i = 0; i < W; ++i)
      for (std::size_t r = 0; r < 4; ++r)
        for (std::size_t c = 0; c < 3; ++c) k[block.corner[r][lane + i] + c] += force[3 * r + c][i];
  }

  static void forces(BlockSpan blocks, const double* u, double* k) noexcept {
    for (ElementBlock* block = blocks.data; block != blocks.data + blocks.size; ++block) {
      for (std::size_t lane = 0; lane < kBlockSize; lane += W) {
        const Matrix f = deformation(*block, lane, u);
        const Matrix r = rotate(*block, lane, f);
        const Matrix s = stress(*block, lane, strain(transposed_product(r, f)));
        Matrix p;
        for (std::size_t i = 0; i < 3; ++i)
          for (std::size_t j = 0; j < 3; ++j)
            p.m[3 * i + j] = r.m[3 * i] * s.m[j] + r.m[3 * i + 1] * s.m[3 + j] + r.m[3 * i + 2] * s.m[6 + j];
        scatter(*block, lane, p, k);
      }
    }
  }

  static void linear_forces(BlockSpan blocks, const double* u, double* k) noexcept {
    for (ElementBlock* block = blocks.data; block != blocks.data + blocks.size; ++block)
      for (std::size_t lane = 0; lane < kBlockSize; lane += W)
        scatter(*block, lane, stress(*block, lane, strain(deformation(*block, lane, u))), k);
  }

  /// Sum of the lanes' W, first lane first.
  static double add_energy(const ElementBlock& block, std::size_t lane, const Strain& e, double sum) {
    const V trace = e.xx + e.yy + e.zz;
    const V square = e.xx * e.xx + e.yy * e.yy + e.zz * e.zz + 2.0 * (e.xy * e.xy + e.xz * e.xz + e.yz * e.yz);
    const V energy = 0.5 * (load(block.two_mu + lane) * square + load(block.lambda + lane) * trace * trace);
    for (std::size_t i = 0; i < W; ++i) sum += energy[i];
    return sum;
  }

  static double energy(BlockSpan blocks, const double* u) noexcept {
    double sum = 0;
    for (ElementBlock* block = blocks.data; block != blocks.data + blocks.size; ++block) {
      for (std::size_t lane = 0; lane < kBlockSize; lane += W) {
        const Matrix f = deformation(*block, lane, u);
        sum = add_energy(*block, lane, strain(transposed_product(rotate(*block, lane, f), f)), sum);
      }
    }
    return sum;
  }

  static double linear_energy(BlockSpan blocks, const double* u) noexcept {
    double sum = 0;
    for (ElementBlock* block = blocks.data; block != blocks.data + blocks.size; ++block)
      for (std::size_t lane = 0; lane < kBlockSize; lane += W)
        sum = add_energy(*block, lane, strain(deformation(*block, lane, u)), sum);
    return sum;
  }

  static constexpr ElementKernels kKernels{forces, linear_forces, energy, linear_energy};
};

}  // namespace
}  // namespace tactus
