// SPDX-License-Identifier: Apache-2.0
/// The element kernel for pairs of vectors of W doubles, included by one source file per instruction set. Linkage as in
/// element_vectors.h. Symbols as in element.h; matrices are rows, element (i, j) at 3 i + j.
#pragma once

#include <tactus/sim/fem/element_block.h>
#include <tactus/sim/fem/element_vectors.h>
#include <tactus/sim/fem/rotation.h>

namespace tactus::sim {
namespace {

template <std::size_t W>
struct Kernel {
  using V = Pair<W>;
  using Half = typename V::Half;
  using Mask = typename V::Mask;
  static constexpr std::size_t kLanes = 2 * W;

  struct Matrix {
    V m[9];
  };
  struct Rotation {
    V q[4];  // w x y z
  };

  /// F at u of the elements from `lane` on.
  static Matrix deformation(const ElementBlock& block, std::size_t lane, const double* u) {
    Matrix f;
    for (std::size_t half = 0; half < 2; ++half) {
      const std::size_t first = lane + half * W;
      Half x[4][3], g[9];
      for (std::size_t r = 0; r < 4; ++r) Vectors<W>::gather(u, block.corner[r] + first, x[r]);
      for (std::size_t i = 0; i < 9; ++i) g[i] = load<Half>(block.gradient[i] + first);
      for (std::size_t c = 0; c < 3; ++c) {
        Half edge[3];
        for (std::size_t r = 0; r < 3; ++r) edge[r] = x[r + 1][c] - x[0][c];
        for (std::size_t j = 0; j < 3; ++j) f.m[3 * c + j].half[half] = edge[0] * g[j] + edge[1] * g[3 + j] + edge[2] * g[6 + j];
      }
    }
    for (std::size_t c = 0; c < 3; ++c) f.m[4 * c] = f.m[4 * c] + 1.0;
    return f;
  }

  static V length2(const Rotation& r) { return r.q[0] * r.q[0] + r.q[1] * r.q[1] + r.q[2] * r.q[2] + r.q[3] * r.q[3]; }

  /// R(q), orthogonal for q of any length but zero.
  static Matrix matrix(const Rotation& rotation, const V& length2) {
    const V &w = rotation.q[0], &x = rotation.q[1], &y = rotation.q[2], &z = rotation.q[3];
    const V s = 2.0 / length2;
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

  struct Turned {
    Rotation to;          // of any length
    Mask arrived, moved;  // moved: by more than rounding
  };
  /// The rotation nearest to F, seen from `start`. With M = R(start)^T F, S = sym(M), G = tr(S) I - S and a = axial(M - M^T) / 2
  /// the rotation from there by the Gibbs vector t (tangent of half the angle along the axis) makes (R^T F) symmetric when
  ///   (G + s I) t = a,   s = a . t
  /// and the best of all rotations when G + s I is positive definite (Davenport's and Shuster's equation). a . t(s) - s is convex
  /// and falls for s >= 0, so that Newton's method from s = 0 always converges. Its first step is written out; the second mostly
  /// only confirms that the first was exact.
  static Turned nearest(const Matrix& f, const Rotation& start) {
    // Smallest determinant, relative to the cube of F's size: below it the rotation is ill-conditioned.
    constexpr double kRegular = 1e-9;
    constexpr double kArrived = 1e-26;  // square of the error of t
    constexpr double kStill = 1e-24;    // square of t that is not worth remembering
    constexpr int kSteps = 8;
    const Matrix m = transposed_product(matrix(start, length2(start)), f);
    const V a = 0.5 * (m.m[7] - m.m[5]), b = 0.5 * (m.m[2] - m.m[6]), c = 0.5 * (m.m[3] - m.m[1]);
    const V xx = m.m[4] + m.m[8], yy = m.m[0] + m.m[8], zz = m.m[0] + m.m[4];  // G
    const V xy = -0.5 * (m.m[1] + m.m[3]), xz = -0.5 * (m.m[2] + m.m[6]), yz = -0.5 * (m.m[5] + m.m[7]);
    const V adj_xx = yy * zz - yz * yz, adj_xy = xz * yz - xy * zz, adj_xz = xy * yz - xz * yy;
    const V adj_yy = xx * zz - xz * xz, adj_yz = xy * xz - xx * yz, adj_zz = xx * yy - xy * xy;
    // det(G + s I) = det + minors s + trace s^2 + s^3,   adj(G + s I) a = p + q s + a s^2
    const V det = xx * adj_xx + xy * adj_xy + xz * adj_xz, minors = adj_xx + adj_yy + adj_zz, trace = xx + yy + zz;
    const Mask maximum = (xx > 0.0) & (adj_zz > 0.0) & (trace > 0.0) & (det > kRegular * trace * trace * trace);
    const V p[3] = {adj_xx * a + adj_xy * b + adj_xz * c, adj_xy * a + adj_yy * b + adj_yz * c,
                    adj_xz * a + adj_yz * b + adj_zz * c};
    const V q[3] = {(yy + zz) * a - xy * b - xz * c, (xx + zz) * b - xy * a - yz * c, (xx + yy) * c - xz * a - yz * b};
    V s = (a * p[0] + b * p[1] + c * p[2]) * det / (det * det + p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    Turned out;
    for (int step = 0;; ++step) {
      const V inverse = 1.0 / (det + s * (minors + s * (trace + s)));
      const V x = (p[0] + s * (q[0] + s * a)) * inverse, y = (p[1] + s * (q[1] + s * b)) * inverse,
              z = (p[2] + s * (q[2] + s * c)) * inverse;
      const V square = x * x + y * y + z * z, left = a * x + b * y + c * z - s;
      const V error = left * minors;  // det times what bounds the error of t beside |t|
      out.arrived = maximum & (error * error * square < kArrived * det * det);
      if (step == kSteps || !(maximum & ~out.arrived).any()) {
        const V* o = start.q;
        out.to = {{o[0] - o[1] * x - o[2] * y - o[3] * z, o[1] + o[0] * x + o[2] * z - o[3] * y,
                   o[2] + o[0] * y + o[3] * x - o[1] * z, o[3] + o[0] * z + o[1] * y - o[2] * x}};
        out.moved = ~out.arrived | (square > kStill);
        return out;
      }
      s = s + V::select(out.arrived, 0.0, left / (1.0 + square));  // converged lanes stay, whatever the other lanes do
    }
  }

  /// Elements that this equation cannot handle (inverted, flat, lost), one by one.
  [[gnu::noinline]] static void repair(const Matrix& f, const Rotation& start, Turned& turned) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      if (turned.arrived.lane(lane)) continue;
      Matrix3 one;
      for (std::size_t i = 0; i < 9; ++i) one.m[i / 3][i % 3] = f.m[i].lane(lane);
      Quat from;
      from.w = start.q[0].lane(lane), from.x = start.q[1].lane(lane), from.y = start.q[2].lane(lane),
      from.z = start.q[3].lane(lane);
      const Quat to = nearest_rotation(one, from);
      V* q = turned.to.q;
      q[0].set_lane(lane, to.w), q[1].set_lane(lane, to.x), q[2].set_lane(lane, to.y), q[3].set_lane(lane, to.z);
    }
  }

  /// R of the elements from `lane` on, iterated from the one stored in their block.
  static Turned find(const ElementBlock& block, std::size_t lane, const Matrix& f, Rotation& start) {
    for (std::size_t i = 0; i < 4; ++i) start.q[i] = V(block.rotation[i] + lane);
    Turned turned = nearest(f, start);
    if ((~turned.arrived).any()) repair(f, start, turned);
    return turned;
  }

  /// The same, and stores R unless it is unchanged: a second call with the same F changes no bit.
  static Matrix rotate(ElementBlock& block, std::size_t lane, const Matrix& f) {
    Rotation start;
    const Turned turned = find(block, lane, f, start);
    const V square = length2(turned.to), scale = 2.0 / (1.0 + square);  // Newton's step for the root: length 1 to second order
    for (std::size_t i = 0; i < 4; ++i)
      V::select(turned.moved, scale * turned.to.q[i], start.q[i]).store_to(block.rotation[i] + lane);
    return matrix(turned.to, square);
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
    const V two_mu(block.two_mu + lane), pressure = V(block.lambda + lane) * (e.xx + e.yy + e.zz);
    const V xy = two_mu * e.xy, xz = two_mu * e.xz, yz = two_mu * e.yz;
    return {{two_mu * e.xx + pressure, xy, xz, xy, two_mu * e.yy + pressure, yz, xz, yz, two_mu * e.zz + pressure}};
  }

  /// k_r = P g_r added to k, element after element.
  [[gnu::always_inline]] static inline void scatter(const ElementBlock& block, std::size_t lane, const Matrix& p, double* k) {
    V force[4][3];
    for (std::size_t r = 0; r < 3; ++r) {
      const V g[3] = {V(block.gradient[3 * r] + lane), V(block.gradient[3 * r + 1] + lane), V(block.gradient[3 * r + 2] + lane)};
      for (std::size_t c = 0; c < 3; ++c) force[r + 1][c] = p.m[3 * c] * g[0] + p.m[3 * c + 1] * g[1] + p.m[3 * c + 2] * g[2];
    }
    for (std::size_t c = 0; c < 3; ++c) force[0][c] = 0.0 - force[1][c] - force[2][c] - force[3][c];
    scatter_half<0>(block, lane, force, k);
    scatter_half<1>(block, lane + W, force, k);
  }
  template <std::size_t H>
  [[gnu::always_inline]] static inline void scatter_half(const ElementBlock& block, std::size_t lane, const V (&force)[4][3],
                                                         double* k) {
    const auto rows = [&](std::size_t r) {
      const Half vectors[3] = {force[r][0].half[H], force[r][1].half[H], force[r][2].half[H]};
      return typename Vectors<W>::Rows(vectors);
    };
    const typename Vectors<W>::Rows corner[4] = {rows(0), rows(1), rows(2), rows(3)};
    for (std::size_t i = 0; i < W; ++i)
      for (std::size_t r = 0; r < 4; ++r) corner[r].add_to(k + block.corner[r][lane + i], i);
  }

  static void forces(BlockSpan blocks, const double* u, double* k) noexcept {
    for (ElementBlock* block = blocks.data; block != blocks.data + blocks.size; ++block) {
      for (std::size_t lane = 0; lane < kBlockSize; lane += kLanes) {
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
      for (std::size_t lane = 0; lane < kBlockSize; lane += kLanes)
        scatter(*block, lane, stress(*block, lane, strain(deformation(*block, lane, u))), k);
  }

  /// Sum of the lanes' W, first lane first.
  static double add_energy(const ElementBlock& block, std::size_t lane, const Strain& e, double sum) {
    const V trace = e.xx + e.yy + e.zz;
    const V square = e.xx * e.xx + e.yy * e.yy + e.zz * e.zz + 2.0 * (e.xy * e.xy + e.xz * e.xz + e.yz * e.yz);
    const V energy = 0.5 * (V(block.two_mu + lane) * square + V(block.lambda + lane) * trace * trace);
    for (std::size_t i = 0; i < kLanes; ++i) sum += energy.lane(i);
    return sum;
  }

  static double energy(BlockSpan blocks, const double* u) noexcept {
    double sum = 0;
    for (ElementBlock* block = blocks.data; block != blocks.data + blocks.size; ++block) {
      for (std::size_t lane = 0; lane < kBlockSize; lane += kLanes) {
        const Matrix f = deformation(*block, lane, u);
        Rotation start;
        const Rotation r = find(*block, lane, f, start).to;
        sum = add_energy(*block, lane, strain(transposed_product(matrix(r, length2(r)), f)), sum);
      }
    }
    return sum;
  }

  static double linear_energy(BlockSpan blocks, const double* u) noexcept {
    double sum = 0;
    for (ElementBlock* block = blocks.data; block != blocks.data + blocks.size; ++block)
      for (std::size_t lane = 0; lane < kBlockSize; lane += kLanes)
        sum = add_energy(*block, lane, strain(deformation(*block, lane, u)), sum);
    return sum;
  }

  static void turn(BlockSpan blocks, const double* u) noexcept {
    for (ElementBlock* block = blocks.data; block != blocks.data + blocks.size; ++block)
      for (std::size_t lane = 0; lane < kBlockSize; lane += kLanes) rotate(*block, lane, deformation(*block, lane, u));
  }

  static constexpr std::size_t kParts = 8 / W;  ///< vectors that hold eight sums, whatever W is

  /// 0 x is NaN where x is NaN or infinite.
  static bool all_zero(const Half (&zero)[kParts]) {
    for (std::size_t i = 0; i < 8; ++i)
      if (zero[i / W][i % W] != 0.0) return false;
    return true;
  }

  struct MotionSums {
    Half work[kParts] = {}, farthest[kParts] = {}, zero[kParts] = {};

    void add(const double* f, const double* u0, const double* u1, const double* v1, double* u, double* v) {
      for (std::size_t part = 0; part < kParts; ++part) {
        const std::size_t i = part * W;
        const Half to = load<Half>(u1 + i), speed = load<Half>(v1 + i), du = to - load<Half>(u0 + i), size = du < 0.0 ? -du : du;
        work[part] += load<Half>(f + i) * du;
        farthest[part] = size > farthest[part] ? size : farthest[part];
        zero[part] += 0.0 * (du + speed);
        store(u + i, to);
        store(v + i, speed);
      }
    }
  };

  static Motion motion(const double* f, const double* u0, const double* u1, const double* v1, double* u, double* v,
                       std::size_t n) noexcept {
    MotionSums sums;
    std::size_t i = 0;
    for (; i + 8 <= n; i += 8) sums.add(f + i, u0 + i, u1 + i, v1 + i, u + i, v + i);
    double rest[6][8] = {};
    for (std::size_t k = 0; i + k < n; ++k) {
      rest[0][k] = f[i + k], rest[1][k] = u0[i + k];
      rest[2][k] = u[i + k] = u1[i + k];
      rest[3][k] = v[i + k] = v1[i + k];
    }
    sums.add(rest[0], rest[1], rest[2], rest[3], rest[4], rest[5]);
    Motion out{0, 0, all_zero(sums.zero)};
    for (std::size_t k = 0; k < 8; ++k) {
      out.work += sums.work[k / W][k % W];
      const double size = sums.farthest[k / W][k % W];
      if (size > out.farthest) out.farthest = size;
    }
    return out;
  }

  static bool finite(const double* x, std::size_t n) noexcept {
    Half zero[kParts] = {};
    std::size_t i = 0;
    for (; i + 8 <= n; i += 8)
      for (std::size_t part = 0; part < kParts; ++part) zero[part] += 0.0 * load<Half>(x + i + part * W);
    double rest = 0;
    for (; i < n; ++i) rest += 0.0 * x[i];
    return rest == 0 && all_zero(zero);
  }

  static constexpr ElementKernels kKernels{forces, linear_forces, energy, linear_energy, turn, motion, finite};
};

}  // namespace
}  // namespace tactus::sim
