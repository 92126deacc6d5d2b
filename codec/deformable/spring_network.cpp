// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/spring_network.h>

#include <algorithm>
#include <cfloat>
#include <cmath>

#include <tactus/deformable/rest_distance.h>

static_assert(FLT_EVAL_METHOD == 0, "both ends compute the same bits only if no operation has more");

namespace tactus {
namespace {

constexpr std::size_t kAxes = 3;
constexpr double kIsotropic = 0x1p-8;  // of a spring's stiffness along its direction

using Pair = std::uint64_t;  // of places, the smaller first

/// Each member and the nearest others at other places.
std::vector<Pair> near_pairs(std::span<const Vec3i> rest, std::span<const std::uint32_t> members) {
  const RestDistance distance(rest);
  std::vector<Pair> out;
  std::vector<std::uint64_t> near;  // distance, then place
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

}  // namespace tactus
