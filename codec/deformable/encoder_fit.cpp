// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/encoder_fit.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace tactus {

// ==== mode projection ====

namespace {

constexpr std::size_t kLanes = 8;  // sums in a fixed order that a compiler can vectorise

constexpr double kRidge = 1e-3;  // dependent modes share what they have in common instead of cancelling each other

/// L L^T = gram with its ridge, in place. The pivot of a mode that is zero everywhere is raised.
void factorise(std::vector<double>& gram, std::size_t n) {
  for (std::size_t k = 0; k < n; ++k) gram[k * n + k] *= 1 + kRidge;
  for (std::size_t j = 0; j < n; ++j) {
    for (std::size_t k = 0; k < j; ++k)
      for (std::size_t i = j; i < n; ++i) gram[i * n + j] -= gram[i * n + k] * gram[j * n + k];
    const double pivot = std::sqrt(std::max(gram[j * n + j], 1e-9));
    gram[j * n + j] = pivot;
    for (std::size_t i = j + 1; i < n; ++i) gram[i * n + j] /= pivot;
  }
}

void solve(const std::vector<double>& factor, std::vector<double>& x) {
  const std::size_t n = x.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) x[i] -= factor[i * n + k] * x[k];
    x[i] /= factor[i * n + i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) x[i] -= factor[k * n + i] * x[k];
    x[i] /= factor[i * n + i];
  }
}

}  // namespace

ModeProjection::ModeProjection(const ModeBasis& basis) : basis_(basis) {
  if (!basis.entries.empty()) invert_entries();
  if (basis.cluster_entries.size() > 0) factorise_clusters();
}

void ModeProjection::invert_entries() {
  const std::size_t modes = basis_.steps.size(), components = basis_.entries.size() / modes;
  const auto entry = [&](std::size_t k, std::size_t i) { return basis_.entries[k * components + i] / 2048.0; };
  gram_.assign(modes * modes, 0.0);
  for (std::size_t a = 0; a < modes; ++a)
    for (std::size_t b = 0; b <= a; ++b)
      for (std::size_t i = 0; i < components; ++i) gram_[a * modes + b] += entry(a, i) * entry(b, i);
  std::vector<double> factor = gram_;
  factorise(factor, modes);
  const std::size_t padded = (components + kLanes - 1) / kLanes * kLanes;
  error_.assign(padded, 0.0F);
  dual_.assign(modes * padded, 0.0F);
  std::vector<double> column(modes);
  for (std::size_t i = 0; i < components; ++i) {
    for (std::size_t k = 0; k < modes; ++k) column[k] = entry(k, i);
    solve(factor, column);
    for (std::size_t k = 0; k < modes; ++k) dual_[k * padded + i] = static_cast<float>(column[k]);
  }
}

void ModeProjection::factorise_clusters() {
  const std::size_t functions = basis_.steps.size() / 3;
  factor_.assign(functions * functions, 0.0);
  for (std::size_t v = 0; v < basis_.cluster_entries.size(); ++v)
    for (const ClusterEntry& a : basis_.cluster_entries[v])
      for (const ClusterEntry& b : basis_.cluster_entries[v])
        for (std::size_t i = 0; i < 4; ++i)
          for (std::size_t j = 0; j < 4; ++j)
            factor_[(std::size_t{4} * a.cluster + i) * functions + std::size_t{4} * b.cluster + j] +=
                a.values[i] / 2048.0 * (b.values[j] / 2048.0);
  factorise(factor_, functions);
  for (std::vector<double>& sum : sum_) sum.resize(functions);
}

void ModeProjection::project_on_clusters(std::span<const Vec3i> error, std::span<float> coefficients) noexcept {
  for (std::vector<double>& sum : sum_) std::ranges::fill(sum, 0.0);
  for (std::size_t v = 0; v < error.size(); ++v)
    for (const ClusterEntry& entry : basis_.cluster_entries[v])
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t axis = 0; axis < 3; ++axis)
          sum_[axis][std::size_t{4} * entry.cluster + i] += entry.values[i] / 2048.0 * error[v][axis];
  for (std::vector<double>& sum : sum_) solve(factor_, sum);
  for (std::size_t k = 0; k < coefficients.size(); ++k) coefficients[k] = static_cast<float>(sum_[k % 3][k / 3]);
}

void ModeProjection::project(std::span<const Vec3i> error, std::span<float> coefficients) noexcept {
  if (!factor_.empty()) return project_on_clusters(error, coefficients);
  for (std::size_t v = 0; v < error.size(); ++v)
    for (std::size_t axis = 0; axis < 3; ++axis) error_[3 * v + axis] = static_cast<float>(error[v][axis]);
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    const float* dual = dual_.data() + k * error_.size();
    std::array<float, kLanes> sum{};
    for (std::size_t i = 0; i < error_.size(); i += kLanes)
      for (std::size_t lane = 0; lane < kLanes; ++lane) sum[lane] += dual[i + lane] * error_[i + lane];
    coefficients[k] = ((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7]));
  }
}

// ==== area fit ====

namespace {

constexpr std::size_t kAreaLanes = 4;  // sums in a fixed order that a compiler can vectorise
constexpr float kMostWeight = 64;      // beyond it the rest of the shape would be given up
constexpr int kSteps = 6;              // of conjugate gradients; more of them save no bits
constexpr float kConverged = 1e-6F;    // of the first gradient's square: the rest is rounding

float dot(const float* a, const float* b, std::size_t n) noexcept {
  std::array<float, kAreaLanes> sum{};
  for (std::size_t i = 0; i < n; i += kAreaLanes)
    for (std::size_t lane = 0; lane < kAreaLanes; ++lane) sum[lane] += a[i + lane] * b[i + lane];
  return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

void add(float factor, const float* a, std::span<float> sum) noexcept {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += factor * a[i];
}

}  // namespace

AreaFit::AreaFit(const ModeBasis& basis, std::span<const double> gram)
    : basis_(basis), modes_((basis.steps.size() + kAreaLanes - 1) / kAreaLanes * kAreaLanes) {
  if (gram.empty()) return;
  const std::size_t modes = basis.steps.size();
  gram_.resize(modes_ * modes_);
  scale_.resize(modes_);
  for (std::size_t a = 0; a < modes; ++a) {
    for (std::size_t b = 0; b <= a; ++b) gram_[a * modes_ + b] = gram_[b * modes_ + a] = static_cast<float>(gram[a * modes + b]);
    float& diagonal = gram_[a * modes_ + a];
    diagonal *= static_cast<float>(1 + kRidge);
    scale_[a] = diagonal > 0 ? 1 / diagonal : 0;
  }
  rows_.resize(3 * kMostVertices * modes_);
  for (std::vector<float>* v : {&start_, &change_, &gradient_, &scaled_, &direction_, &image_}) v->resize(modes_);
}

/// Rows and weights, and the gradient: where the weighted error falls fastest.
void AreaFit::read_area(std::span<const Vec3i> error, const BoundedArea& area) noexcept {
  const std::size_t components = 3 * error.size();
  weighed_ = 0;
  std::ranges::fill(gradient_, 0.0F);
  for (const std::uint32_t v : area.vertices.first(std::min(area.vertices.size(), kMostVertices))) {
    std::array<float*, 3> row{};
    std::array<float, 3> left{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      row[axis] = rows_.data() + (3 * weighed_ + axis) * modes_;
      const std::int16_t* entry = basis_.entries.data() + 3 * std::size_t{v} + axis;
      for (std::size_t k = 0; k < basis_.steps.size(); ++k) row[axis][k] = static_cast<float>(entry[k * components]) / 2048;
      left[axis] = static_cast<float>(error[v][axis]) - dot(row[axis], start_.data(), modes_);
    }
    const float square = (left[0] * left[0] + left[1] * left[1]) + left[2] * left[2];
    const float weight = area.outside * area.outside / std::max(area.inside * area.inside + square, 1.0F);
    if (weight <= 1) continue;
    more_[weighed_] = std::min(weight, kMostWeight) - 1;
    for (std::size_t axis = 0; axis < 3; ++axis) add(more_[weighed_] * left[axis], row[axis], gradient_);
    ++weighed_;
  }
}

/// Weighted Gram matrix times direction.
void AreaFit::find_image() noexcept {
  std::ranges::fill(image_, 0.0F);
  for (std::size_t k = 0; k < modes_; ++k) add(direction_[k], gram_.data() + k * modes_, image_);
  for (std::size_t i = 0; i < 3 * weighed_; ++i) {
    const float* row = rows_.data() + i * modes_;
    add(more_[i / 3] * dot(row, direction_.data(), modes_), row, image_);
  }
}

/// Scales it by mode; the product of both.
float AreaFit::measure_gradient() noexcept {
  for (std::size_t k = 0; k < modes_; ++k) scaled_[k] = scale_[k] * gradient_[k];
  return dot(gradient_.data(), scaled_.data(), modes_);
}

void AreaFit::improve(std::span<const Vec3i> error, const BoundedArea& area, std::span<float> coefficients) noexcept {
  if (gram_.empty() || area.inside >= area.outside) return;
  std::ranges::copy(coefficients, start_.begin());
  std::ranges::fill(change_, 0.0F);
  read_area(error, area);
  float slope = measure_gradient();
  const float enough = kConverged * slope;
  std::ranges::copy(scaled_, direction_.begin());
  for (int i = 0; i < kSteps && slope > enough; ++i) {
    find_image();
    const float step = slope / dot(direction_.data(), image_.data(), modes_);
    add(step, direction_.data(), change_);
    add(-step, image_.data(), gradient_);
    const float before = slope;
    slope = measure_gradient();
    for (std::size_t k = 0; k < modes_; ++k) direction_[k] = scaled_[k] + slope / before * direction_[k];
  }
  for (std::size_t k = 0; k < coefficients.size(); ++k) coefficients[k] += change_[k];
}

}  // namespace tactus
