// SPDX-License-Identifier: Apache-2.0
/// A network of springs between vertices near each other. spec/50-deformable.md section 10.2. Internal to the library.
///   energy x = sum over springs of (n . d)^2 + |d|^2 / 256,  d the difference of the displacements of its ends, n its direction at rest
/// The first part is that of springs; the second keeps a flat sheet from moving out of its plane without effort.
/// binary64 in the written order: both ends must agree on every bit.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tactus/base/fixed.h>

namespace tactus {

/// A few columns of displacements, row by row: 3 rows for each vertex. Columns are padded with zeros to a multiple of kLanes.
struct Columns {
  static constexpr std::size_t kLanes = 8;

  Columns() = default;
  Columns(std::size_t height, std::size_t width)
      : rows(height), columns(width), stride((width + kLanes - 1) / kLanes * kLanes), values(rows * stride) {}
  double* row(std::size_t i) noexcept { return values.data() + i * stride; }
  const double* row(std::size_t i) const noexcept { return values.data() + i * stride; }

  std::size_t rows = 0, columns = 0, stride = 0;
  std::vector<double> values;
};

class SpringNetwork {
 public:
  static constexpr std::size_t kNear = 24;

  /// in   rest   all vertices of the object;  members  those of the network;  free  by member
  /// pre  2^20 vertices at most.   time 5 ns * members^2, allocates
  SpringNetwork(std::span<const Vec3i> rest, std::span<const std::uint32_t> members, std::span<const std::uint8_t> free);

  /// An upper bound of the largest eigenvalue of K, at least 1.
  double bound() const noexcept { return bound_; }
  /// K x, zero where a member is not free.   pre  both have three rows for each member.   time O(springs * columns)
  void multiply(const Columns& x, Columns& out) const noexcept;

 private:
  struct Spring {
    std::array<std::uint32_t, 2> ends;  // places in `members`
    std::array<double, 3> direction;
  };

  void find_bound(std::size_t members);

  std::vector<Spring> springs_;
  std::vector<std::uint32_t> fixed_;  // places
  double bound_ = 1;
};

}  // namespace tactus
