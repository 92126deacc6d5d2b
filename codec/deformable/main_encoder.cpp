// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <memory>

#include <tactus/deformable/encoder_side.h>
#include <tactus/deformable/main_syntax.h>
#include <tactus/deformable/mode_projection.h>
#include <tactus/deformable/vertex_coder.h>

namespace tactus {
namespace {

constexpr double kRounding = 0.8660254038;  // grid units: farthest that a vertex lies from its nearest grid point
constexpr float kDeadZone = 0.7F;           // coefficients below this many steps are not sent

struct CodedVertex {
  VertexContext context;
  Vec3i residual{};
};

/// Nearest residual, its components then moved towards zero while the bound allows: short symbols are cheap.
Vec3i quantise(const Vec3i& truth, const Vec3i& place, std::uint32_t bound, std::int64_t step) noexcept {
  const std::int64_t limit = std::int64_t{bound} * bound;
  std::array<std::int64_t, 3> error{};
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    error[i] = std::int64_t{truth[i]} - place[i];
    sum += error[i] * error[i];
  }
  if (sum <= limit) return {};
  Vec3i out{};
  sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    out[i] = saturate32(round_div(error[i], step));
    error[i] -= out[i] * step;
    sum += error[i] * error[i];
  }
  for (std::size_t i = 0; i < 3; ++i) {
    if (out[i] == 0) continue;
    const std::int64_t sign = out[i] > 0 ? 1 : -1;
    const std::int64_t moved = error[i] + sign * step;
    const std::int64_t after = sum - error[i] * error[i] + moved * moved;
    if (after > limit) continue;
    out[i] -= static_cast<std::int32_t>(sign);
    sum = after;
  }
  return out;
}

class MainSide : public DeformableEncoderSide {
 public:
  MainSide(const StreamHeader& header, const DeformableObject& mesh, const DeformableEncoderOptions& options)
      : DeformableEncoderSide(header, mesh, options),
        hierarchy_(vertex_hierarchy(mesh)),
        predictor_(mesh),
        pass_(hierarchy_, mesh.rest.size()),
        projection_(mesh.basis),
        error_(mesh.rest.size()),
        coefficients_(mesh.basis.steps.size()),
        scaled_(mesh.basis.steps.size()),
        projected_(mesh.basis.steps.size()) {
    coded_.reserve(mesh.rest.size());
  }
  EncodedDeformablePacket encode(const DeformableTruth& frame, Layer half) noexcept override;

 private:
  MainHead head_for(const DeformableTruth& frame, Layer half) const noexcept;
  bool bounds_hold(const DeformableTruth& frame, bool key) noexcept;
  void choose_coefficients(std::span<const Vec3i> truth, std::uint32_t visual) noexcept;
  void move_modes(std::span<const Vec3i> truth, std::uint32_t visual) noexcept;
  std::uint32_t choose_residuals(std::span<const Vec3i> truth) noexcept;
  std::size_t write(MainHead head) noexcept;

  VertexHierarchy hierarchy_;
  ShapePredictor predictor_;
  VertexCoder pass_;
  ModeProjection projection_;
  std::vector<Vec3i> error_;
  std::vector<std::int32_t> coefficients_, scaled_;  // in steps; in grid units
  std::vector<float> projected_;
  std::vector<CodedVertex> coded_;
};

/// Bounds on the grid, smaller by the truth's own rounding, so that they hold for the unrounded truth.
MainHead MainSide::head_for(const DeformableTruth& frame, Layer half) const noexcept {
  const double unit = std::ldexp(1.0, -header_.grid.position);
  const auto units = [unit](double metres) {
    return static_cast<std::uint32_t>(std::clamp(metres / unit - kRounding, 0.0, double{kMaxVisualBound}));
  };
  const DeformableThresholds& t = options_.thresholds;
  MainHead head;
  head.key = key_due(frame.tick);
  head.baseline_delta = baseline_delta();
  head.half = half;
  head.completes = half == Layer::visual && !head.key && held_.tick == frame.tick;
  head.tick_delta = static_cast<std::uint32_t>(frame.tick - base(head.key).tick);
  head.visual = units(options_.visual_share * t.visual);
  head.touched = is_felt(frame);
  if (!head.touched) return head;
  head.triangle = frame.touch->triangle;
  const std::uint32_t haptic = units(options_.haptic_share * haptic_threshold(t, *frame.touch));
  while (head.haptic < kMaxHapticLevel && haptic_bound(head.haptic + 1) <= haptic) ++head.haptic;
  return head;
}

/// A key packet forgets the whole shape, and so is due as soon as any bound is broken.
bool MainSide::bounds_hold(const DeformableTruth& frame, bool key) noexcept {
  predictor_.predict(held_, frame.tick, expected_);
  for (std::uint32_t v = 0; v < frame.truth.size(); ++v) {
    if (!key && !pass_.codes(v)) continue;
    const std::int64_t bound = pass_.bound_of(v);
    if (squared_distance(frame.truth[v], expected_[v]) > bound * bound) return false;
  }
  return true;
}

void MainSide::choose_coefficients(std::span<const Vec3i> truth, std::uint32_t visual) noexcept {
  if (coefficients_.empty()) return;
  for (std::size_t v = 0; v < truth.size(); ++v)
    for (std::size_t axis = 0; axis < 3; ++axis) error_[v][axis] = truth[v][axis] - expected_[v][axis];
  projection_.project(error_, projected_);
  for (std::size_t k = 0; k < coefficients_.size(); ++k) {
    const float steps = projected_[k] / static_cast<float>(coefficient_step(mesh_, visual, k));
    const float size = std::min(1e9F, std::abs(steps));
    const auto rounded = size >= kDeadZone ? static_cast<std::int32_t>(std::floor(size + 0.5F)) : 0;
    coefficients_[k] = steps < 0 ? -rounded : rounded;
  }
}

void MainSide::move_modes(std::span<const Vec3i> truth, std::uint32_t visual) noexcept {
  choose_coefficients(truth, visual);
  std::copy(coefficients_.begin(), coefficients_.end(), scaled_.begin());
  scale_coefficients(mesh_, visual, scaled_);
  predictor_.add_modes(scaled_, expected_);
}

/// Quantise every vertex as the decoder will see it. Returns how many have a residual.
std::uint32_t MainSide::choose_residuals(std::span<const Vec3i> truth) noexcept {
  coded_.clear();
  std::uint32_t updates = 0;
  pass_.run(
      expected_, next_.displacement,
      [&](std::uint32_t v, const VertexContext& context, const Vec3i& place, std::uint32_t bound, std::int64_t step) noexcept {
        const Vec3i residual = quantise(truth[v], place, bound, step);
        coded_.push_back({context, residual});
        updates += residual != Vec3i{} ? 1u : 0u;
        return residual;
      });
  return updates;
}

std::size_t MainSide::write(MainHead head) noexcept {
  RangeEncoder coder(buffer(head.half).subspan(2));
  MainModels models = main_start_models();
  code_main_start(coder, models, mesh_, header_.baseline_span, head);
  code_main_head(coder, models, mesh_, rings_, base(head.key), head);
  if (head.half != Layer::haptic) code_coefficients(coder, models, coefficients_);
  for (CodedVertex& c : coded_) code_vertex(coder, models, head.density, c.context, c.residual);
  return 2 + coder.finish();
}

EncodedDeformablePacket MainSide::encode(const DeformableTruth& frame, Layer half) noexcept {
  MainHead head = head_for(frame, half);
  if (half == Layer::haptic && !head.touched) return {};
  pass_.set_bounds(head.visual, head.touched ? haptic_bound(head.haptic) : head.visual,
                   head.touched ? area(head.triangle) : std::span<const std::uint32_t>{}, half);
  if (!key_requested() && bounds_hold(frame, head.key)) return {};
  // What is felt goes first: a key packet of the rest alone would forget it.
  if (half == Layer::visual && head.key && head.touched) return {};
  const DeformableState& from = base(head.key);
  if (head.key) predictor_.predict(from, frame.tick, expected_);
  if (mesh_.split) pass_.begin_half(from, head.completes, expected_, next_.displacement);
  if (half == Layer::haptic) {
    keep_motion(from, next_);
  } else {
    move_modes(frame.truth, head.visual);
    predictor_.learn(from, frame.tick, next_);
  }
  const std::uint32_t updates = choose_residuals(frame.truth);
  const std::uint64_t share = (std::uint64_t{updates} << 8) / coded_.size();
  head.density = half == Layer::haptic ? from.density : share < 3 ? 0 : share < 15 ? 1 : share < 64 ? 2 : 3;
  const std::size_t size = write(head);
  pass_.keep_felt(half, next_);
  keep_head(head, from, next_);
  return finish(size, head.key, half, frame.tick, updates);
}

}  // namespace

std::unique_ptr<DeformableEncoderSide> make_main_side(const StreamHeader& header, const DeformableObject& mesh,
                                                      const DeformableEncoderOptions& options) {
  return std::make_unique<MainSide>(header, mesh, options);
}

}  // namespace tactus
