// SPDX-License-Identifier: Apache-2.0
/// Vectors of doubles for the element kernel: their width, gather and scatter of vertices. Internal linkage throughout and no
/// function of the standard library, so that no code for one instruction set can serve in place of another's.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tactus::sim {
namespace {

using Double2 [[gnu::vector_size(16)]] = double;
using Double4 [[gnu::vector_size(32)]] = double;
using Double8 [[gnu::vector_size(64)]] = double;

template <class T>
T load(const double* p) {
  T v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}
template <class T>
void store(double* p, const T& v) {
  __builtin_memcpy(p, &v, sizeof v);
}
template <class T>
void add(double* p, const T& v) {
  store(p, load<T>(p) + v);
}

/// W doubles. Vertices lie in memory as x, y, z and an unused fourth; one vector holds the x of all lanes, one the y, one the z.
template <std::size_t W>
struct Vectors;

template <>
struct Vectors<2> {
  using Double = Double2;
  using Mask [[gnu::vector_size(16)]] = long long;

  static void gather(const double* u, const std::uint32_t* index, Double (&out)[3]) {
    const Double a = load<Double>(u + index[0]), b = load<Double>(u + index[1]);
    const Double c = load<Double>(u + index[0] + 2), d = load<Double>(u + index[1] + 2);
    out[0] = __builtin_shufflevector(a, b, 0, 2);
    out[1] = __builtin_shufflevector(a, b, 1, 3);
    out[2] = __builtin_shufflevector(c, d, 0, 2);
  }

  /// The same vectors by vertex.
  struct Rows {
    Double xy[2], z;
    explicit Rows(const Double (&v)[3])
        : xy{__builtin_shufflevector(v[0], v[1], 0, 2), __builtin_shufflevector(v[0], v[1], 1, 3)}, z(v[2]) {}
    void add_to(double* k, std::size_t lane) const {
      add(k, xy[lane]);
      k[2] += z[lane];
    }
  };
};

#ifdef __AVX__
template <>
struct Vectors<4> {
  using Double = Double4;
  using Mask [[gnu::vector_size(32)]] = long long;

  static Double two(const double* low, const double* high) {
    return __builtin_shufflevector(load<Double2>(low), load<Double2>(high), 0, 1, 2, 3);
  }
  static void gather(const double* u, const std::uint32_t* index, Double (&out)[3]) {
    const Double a = two(u + index[0], u + index[2]), b = two(u + index[1], u + index[3]);
    const Double c = two(u + index[0] + 2, u + index[2] + 2), d = two(u + index[1] + 2, u + index[3] + 2);
    out[0] = __builtin_shufflevector(a, b, 0, 4, 2, 6);
    out[1] = __builtin_shufflevector(a, b, 1, 5, 3, 7);
    out[2] = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  }

  struct Rows {
    Double row[4];
    explicit Rows(const Double (&v)[3]) {
      const Double zero{};
      const Double a = __builtin_shufflevector(v[0], v[1], 0, 4, 2, 6), b = __builtin_shufflevector(v[0], v[1], 1, 5, 3, 7);
      const Double c = __builtin_shufflevector(v[2], zero, 0, 4, 2, 6), d = __builtin_shufflevector(v[2], zero, 1, 5, 3, 7);
      row[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
      row[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
      row[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
      row[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
    }
    void add_to(double* k, std::size_t lane) const { add(k, row[lane]); }
  };
};
#endif

#ifdef __AVX512F__
template <>
struct Vectors<8> {
  using Double = Double8;
  using Mask [[gnu::vector_size(64)]] = long long;

  static Double two(const double* low, const double* high) {
    return __builtin_shufflevector(load<Double4>(low), load<Double4>(high), 0, 1, 2, 3, 4, 5, 6, 7);
  }
  static Double even(const Double& a, const Double& b) { return __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14); }
  static Double odd(const Double& a, const Double& b) { return __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15); }
  static void gather(const double* u, const std::uint32_t* index, Double (&out)[3]) {
    const Double a = two(u + index[0], u + index[2]), b = two(u + index[1], u + index[3]);
    const Double c = two(u + index[4], u + index[6]), d = two(u + index[5], u + index[7]);
    const Double xz[2] = {even(a, b), even(c, d)}, y[2] = {odd(a, b), odd(c, d)};
    out[0] = __builtin_shufflevector(xz[0], xz[1], 0, 1, 4, 5, 8, 9, 12, 13);
    out[1] = __builtin_shufflevector(y[0], y[1], 0, 1, 4, 5, 8, 9, 12, 13);
    out[2] = __builtin_shufflevector(xz[0], xz[1], 2, 3, 6, 7, 10, 11, 14, 15);
  }

  struct Rows {
    Double rows[4];  // of lanes 0 and 2, 1 and 3, 4 and 6, 5 and 7
    explicit Rows(const Double (&v)[3]) {
      const Double zero{};
      const Double xy[2] = {even(v[0], v[1]), odd(v[0], v[1])}, z[2] = {even(v[2], zero), odd(v[2], zero)};
      for (std::size_t i = 0; i < 2; ++i) {
        rows[i] = __builtin_shufflevector(xy[i], z[i], 0, 1, 8, 9, 2, 3, 10, 11);
        rows[2 + i] = __builtin_shufflevector(xy[i], z[i], 4, 5, 12, 13, 6, 7, 14, 15);
      }
    }
    void add_to(double* k, std::size_t lane) const {
      const Double& both = rows[2 * (lane / 4) + lane % 2];
      add(k, lane % 4 < 2 ? __builtin_shufflevector(both, both, 0, 1, 2, 3) : __builtin_shufflevector(both, both, 4, 5, 6, 7));
    }
  };
};
#endif

/// Two vectors processed together, so that each hides the latency of the other.
template <std::size_t W>
struct Pair {
  using Half = typename Vectors<W>::Double;
  Half half[2];

  Pair() = default;
  Pair(double x) : half{Half{} + x, Half{} + x} {}  // NOLINT(google-explicit-constructor): factors and terms of formulas
  Pair(const Half& a, const Half& b) : half{a, b} {}
  explicit Pair(const double* p) : half{load<Half>(p), load<Half>(p + W)} {}
  void store_to(double* p) const {
    store(p, half[0]);
    store(p + W, half[1]);
  }
  double lane(std::size_t i) const { return half[i / W][i % W]; }
  void set_lane(std::size_t i, double x) { half[i / W][i % W] = x; }

  friend Pair operator+(const Pair& x, const Pair& y) { return {x.half[0] + y.half[0], x.half[1] + y.half[1]}; }
  friend Pair operator-(const Pair& x, const Pair& y) { return {x.half[0] - y.half[0], x.half[1] - y.half[1]}; }
  friend Pair operator*(const Pair& x, const Pair& y) { return {x.half[0] * y.half[0], x.half[1] * y.half[1]}; }
  friend Pair operator/(const Pair& x, const Pair& y) { return {x.half[0] / y.half[0], x.half[1] / y.half[1]}; }

  struct Mask {
    typename Vectors<W>::Mask half[2];  // -1: true

    friend Mask operator&(const Mask& x, const Mask& y) { return {{x.half[0] & y.half[0], x.half[1] & y.half[1]}}; }
    friend Mask operator|(const Mask& x, const Mask& y) { return {{x.half[0] | y.half[0], x.half[1] | y.half[1]}}; }
    friend Mask operator~(const Mask& x) { return {{~x.half[0], ~x.half[1]}}; }
    bool lane(std::size_t i) const { return half[i / W][i % W] != 0; }
    bool any() const {
      const auto both = half[0] | half[1];
      long long bits = 0;
      for (std::size_t i = 0; i < W; ++i) bits |= both[i];
      return bits != 0;
    }
  };
  friend Mask operator<(const Pair& x, const Pair& y) { return {{x.half[0] < y.half[0], x.half[1] < y.half[1]}}; }
  friend Mask operator>(const Pair& x, const Pair& y) { return y < x; }
  static Pair select(const Mask& mask, const Pair& x, const Pair& y) {
    return {mask.half[0] ? x.half[0] : y.half[0], mask.half[1] ? x.half[1] : y.half[1]};
  }
};

}  // namespace
}  // namespace tactus::sim
