// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/spring_basis.h>

#include <algorithm>
#include <span>
#include <utility>

#include <tactus/deformable/coding_order.h>
#include <tactus/deformable/kriging.h>
#include <tactus/deformable/ritz.h>
#include <tactus/deformable/spring_network.h>

namespace tactus {
namespace {

constexpr std::size_t kAxes = 3;
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
        place_(object.rest.size()),
        free_(object.rest.size(), 1) {
    for (std::uint32_t i = 0; i < order_.order.size(); ++i) place_[order_.order[i]] = i;
    for (const std::uint32_t v : object.spring_basis.fixed) free_[place_[v]] = 0;
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
    for (const VertexParent& p : parents_[i]) row(place_[p.vertex], p.weight * 0x1p-15);
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
  std::vector<std::uint32_t> place_;    // by vertex, in the order
  std::vector<std::uint8_t> free_;      // by place
  std::vector<std::uint32_t> anchors_;  // places
};

}  // namespace

ModeBasis spring_basis(const DeformableObject& object) { return Builder(object).build(); }

}  // namespace tactus
