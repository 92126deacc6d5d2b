// SPDX-License-Identifier: Apache-2.0
#include <tactus/mesh/basis.h>

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <span>
#include <vector>

#include <tactus/mesh/graph.h>

static_assert(FLT_EVAL_METHOD == 0, "both ends compute the same bits only if no operation has more");

namespace tactus {
namespace {

constexpr std::size_t kMostWeights = 4;  // of a vertex
constexpr std::uint32_t kWhole = 1u << 16;
constexpr double kCoarseness = 3;  // of the quantiser steps
constexpr double kFlat = 0x1p-30;  // what is left of a direction that a flat cluster does not have

struct ClusterWeight {
  std::uint8_t cluster = 0;
  std::uint32_t weight = 0;  // x 2^-16; 0: none
};
using ClusterWeights = std::array<ClusterWeight, kMostWeights>;

class Blender {
 public:
  explicit Blender(const DeformableObject& object) : near_(neighbours(object)) {
    for (const std::uint8_t c : object.cluster_basis.clusters) weights_.push_back({ClusterWeight{c, kWhole}});
    for (unsigned round = 0; round < object.cluster_basis.blend; ++round) blend();
  }
  const std::vector<ClusterWeights>& weights() const noexcept { return weights_; }

 private:
  void add(const ClusterWeights& weights, std::uint64_t times) noexcept {
    for (const ClusterWeight& of : weights) {
      if (of.weight == 0) continue;
      if (sum_[of.cluster] == 0) touched_[count_++] = of.cluster;
      sum_[of.cluster] += times * of.weight;
    }
  }
  ClusterWeights take() noexcept {
    const auto end = touched_.begin() + static_cast<std::ptrdiff_t>(count_);
    const auto kept = touched_.begin() + static_cast<std::ptrdiff_t>(std::min(count_, kMostWeights));
    std::partial_sort(touched_.begin(), kept, end,
                      [this](std::uint8_t a, std::uint8_t b) { return sum_[a] != sum_[b] ? sum_[a] > sum_[b] : a < b; });
    std::uint64_t total = 0;
    for (auto c = touched_.begin(); c != kept; ++c) total += sum_[*c];
    ClusterWeights out{};
    std::uint32_t missing = kWhole;
    for (std::size_t i = 0; i < std::min(count_, kMostWeights); ++i) {
      out[i] = {touched_[i], static_cast<std::uint32_t>((sum_[touched_[i]] << 16) / total)};
      missing -= out[i].weight;
    }
    out[0].weight += missing;
    for (auto c = touched_.begin(); c != end; ++c) sum_[*c] = 0;
    count_ = 0;
    return out;
  }
  void blend() {
    before_ = weights_;
    for (std::size_t v = 0; v < weights_.size(); ++v) {
      const auto near = near_[v];
      if (near.empty()) continue;
      add(before_[v], near.size());
      for (const std::uint32_t w : near) add(before_[w], 1);
      weights_[v] = take();
    }
  }

  Neighbours near_;
  std::vector<ClusterWeights> weights_, before_;
  std::array<std::uint64_t, ClusterBasis::kMaxClusters> sum_{};
  std::array<std::uint8_t, ClusterBasis::kMaxClusters> touched_{};
  std::size_t count_ = 0;
};

struct Member {
  std::uint32_t vertex = 0;
  double weight = 0;  // of the cluster
};

/// The functions 1, x, y, z on a cluster, each made orthogonal to those before it.
class Functions {
 public:
  Functions(const DeformableObject& object, std::span<const Member> members) : members_(members) {
    values_[0].assign(members.size(), 1.0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::vector<double>& x = values_[axis + 1];
      for (const Member& m : members)
        x.push_back(static_cast<double>(object.rest[m.vertex][axis]) - object.rest[members[0].vertex][axis]);
      const double before = product(x, x);
      for (std::size_t j = 0; j <= axis; ++j) remove(values_[j], x);
      if (!(product(x, x) > kFlat * before)) std::ranges::fill(x, 0.0);
    }
    for (std::vector<double>& f : values_)
      for (std::size_t i = 0; i < f.size(); ++i) f[i] = members[i].weight * f[i];
  }
  /// By member, times its weight.
  std::span<const double> operator[](std::size_t i) const noexcept { return values_[i]; }

 private:
  double product(std::span<const double> a, std::span<const double> b) const noexcept {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += members_[i].weight * a[i] * b[i];
    return sum;
  }
  void remove(std::span<const double> f, std::span<double> x) const noexcept {
    const double square = product(f, f);
    if (!(square > 0)) return;
    const double factor = product(f, x) / square;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = x[i] - factor * f[i];
  }

  std::span<const Member> members_;
  std::array<std::vector<double>, 4> values_;
};

double largest_of(std::span<const double> values) noexcept {
  double out = 0;
  for (const double f : values) out = std::max(out, std::abs(f));
  return out > 0 ? out : 1;
}

std::uint16_t step_of(std::span<const double> values, double largest) noexcept {
  double square = 0;
  for (const double f : values) square += (f / largest) * (f / largest);
  return static_cast<std::uint16_t>(std::floor(kCoarseness / std::sqrt(std::max(square, 1.0)) * 4096 * 2048 / 2047 + 0.5));
}

}  // namespace

std::uint8_t expected_cluster(std::span<const std::uint32_t> near, std::span<const std::uint8_t> clusters,
                              std::uint32_t vertex) noexcept {
  const auto lowest = std::ranges::min_element(near);
  if (lowest != near.end() && *lowest < vertex) return clusters[*lowest];
  return vertex > 0 ? clusters[vertex - 1] : std::uint8_t{0};
}

ModeBasis cluster_basis(const DeformableObject& object) {
  const std::size_t count = object.cluster_basis.count;
  const Blender blender(object);
  ModeBasis out;
  for (const ClusterWeights& weights : blender.weights()) {
    for (const ClusterWeight& of : weights)
      if (of.weight > 0) out.cluster_entries.items.push_back({of.cluster, {}});
    out.cluster_entries.close();
  }
  std::vector<std::vector<Member>> members(count);
  std::vector<std::vector<std::uint32_t>> indices(count);  // in out.cluster_entries.items
  std::uint32_t index = 0;
  for (std::uint32_t v = 0; v < blender.weights().size(); ++v) {
    for (const ClusterWeight& of : blender.weights()[v]) {
      if (of.weight == 0) continue;
      members[of.cluster].push_back({v, static_cast<double>(of.weight)});
      indices[of.cluster].push_back(index++);
    }
  }
  for (std::size_t c = 0; c < count; ++c) {
    const Functions functions(object, members[c]);
    for (std::size_t i = 0; i < 4; ++i) {
      const double largest = largest_of(functions[i]);
      for (std::size_t m = 0; m < members[c].size(); ++m)
        out.cluster_entries.items[indices[c][m]].values[i] =
            static_cast<std::int16_t>(std::floor(functions[i][m] / largest * ModeBasis::kMaxEntry + 0.5));
      out.steps.insert(out.steps.end(), 3, step_of(functions[i], largest));
    }
  }
  return out;
}

}  // namespace tactus
