// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/area_fit.h>

#include <algorithm>

namespace tactus {
namespace {

constexpr std::size_t kLanes = 4;    // sums in a fixed order that a compiler can vectorise
constexpr double kRidge = 1e-3;      // as of the plain fit
constexpr float kMostWeight = 64;    // beyond it the rest of the shape would be given up
constexpr int kSteps = 6;            // of conjugate gradients; more of them save no bits
constexpr float kConverged = 1e-6F;  // of the first gradient's square: the rest is rounding

float dot(const float* a, const float* b, std::size_t n) noexcept {
  std::array<float, kLanes> sum{};
  for (std::size_t i = 0; i < n; i += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) sum[lane] += a[i + lane] * b[i + lane];
  return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

void add(float factor, const float* a, std::span<float> sum) noexcept {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += factor * a[i];
}

}  // namespace

AreaFit::AreaFit(const ModeBasis& basis, std::span<const double> gram)
    : basis_(basis), modes_((basis.steps.size() + kLanes - 1) / kLanes * kLanes) {
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
