// SPDX-License-Identifier: Apache-2.0
#include <tactus/deformable/deformable_encoder.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <tactus/base/rule.h>
#include <tactus/deformable/displacement.h>
#include <tactus/scene/thesis_component.h>

namespace tactus {

// ==== main encoder ====

namespace {

constexpr double kRounding = 0.8660254038;  // grid units: farthest that a vertex lies from its nearest grid point
constexpr float kDeadZone = 0.7F;           // coefficients below this many steps are not sent

/// Nearest residual. The components of a vertex that predicts no others are then moved towards zero while the limit allows: short symbols
/// are cheap, but what others are predicted from had better be right.
Vec3i quantise(const Vec3i& truth, const Vec3i& predicted, std::uint32_t farthest, std::int64_t step, bool predicts) noexcept {
  const std::int64_t limit = std::int64_t{farthest} * farthest;
  std::array<std::int64_t, 3> error{};
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    error[i] = std::int64_t{truth[i]} - predicted[i];
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
  for (std::size_t i = 0; i < 3 && !predicts; ++i) {
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

/// Every packet costs a header. Where shapes come more often than packets, spare accuracy delays the next one.
double default_fraction(const Scene& scene, const DeformableObject& object) noexcept {
  constexpr double kRareShapes = 0.01;  // [s]
  const double period = object.frame_period / 256.0 / scene.tick_rate;
  return period < kRareShapes ? 0.7 : 1;
}

}  // namespace

MainEncoder::MainEncoder(const Scene& scene, const DeformableObject& object, const DeformableOptions& options,
                         std::unique_ptr<FollowedShape> driven)
    : object_(object),
      thresholds_(options.thresholds),
      visual_fraction_(options.visual_fraction.value_or(default_fraction(scene, object))),
      haptic_fraction_(options.haptic_fraction.value_or(default_fraction(scene, object))),
      unit_(std::ldexp(1.0, -scene.grid.position)),
      baseline_span_(scene.baseline_span),
      hierarchy_(scene.hierarchy(object)),
      rings_(object),
      predictor_(object),
      coder_(*hierarchy_, object.rest.size()),
      projection_(object.basis),
      area_fit_(object.basis, projection_.gram()),
      next_(initial_main_state(object)),
      expected_(object.rest.size()),
      error_(object.rest.size()),
      coefficients_(object.basis.steps.size()),
      scaled_(object.basis.steps.size()),
      projected_(object.basis.steps.size()),
      driven_(std::move(driven)) {
  coded_.reserve(object.rest.size());
  static_cast<void>(main_start_models());  // they are unpacked once, and not within a tick
}

/// Bounds on the grid, smaller by the truth's own rounding, so that they hold for the unrounded truth.
MainHead MainEncoder::head_for(const EncodeRequest<MainState>& request) noexcept {
  const auto units = [this](double metres) {
    return static_cast<std::uint32_t>(std::clamp(metres / unit_ - kRounding, 0.0, double{kMaxVisualBound}));
  };
  MainHead head{request.head};
  head.layer = request.layer;
  head.same_frame = request.layer == Layer::visual && !head.key && request.base.tick == request.tick;
  const double visual = bound_scale_ * thresholds_.visual;
  trigger_[0] = units(visual);
  limit_[0] = head.visual = units(visual_fraction_ * visual);
  head.touched = touch_ != nullptr && thresholds_.weber_fraction;
  if (!head.touched) return head;
  head.triangle = touch_->triangle;
  const double haptic = bound_scale_ * haptic_threshold(thresholds_, *touch_);
  trigger_[1] = std::min(trigger_[0], units(haptic));
  limit_[1] = std::min(limit_[0], units(haptic_fraction_ * haptic));
  while (head.haptic < kMaxHapticIndex && haptic_bound(head.haptic + 1) <= limit_[1]) ++head.haptic;
  return head;
}

/// Of what is in `expected_`.
bool MainEncoder::is_within_bounds() const noexcept {
  for (std::uint32_t v = 0; v < truth_.size(); ++v) {
    const std::int64_t bound = trigger_[coder_.is_inside(v)];
    if (squared_distance(truth_[v], expected_[v]) > bound * bound) return false;
  }
  return true;
}

/// The body alone if it is within the bounds; else with what it differs by now, if the device's path has predicted this shape better than the
/// motion so far.
Following MainEncoder::choose_following(const EncodeRequest<MainState>& request) noexcept {
  const MainState& shown = request.shown;
  if (!driven_ || !driven_->body_at(request.tick, expected_)) return Following::none;
  if (is_within_bounds()) return Following::fading;
  if (!driven_->show(shown, request.tick, error_)) return Following::none;
  predictor_.predict(shown, request.tick, expected_);
  double by_device = 0, alone = 0;
  for (std::size_t v = 0; v < truth_.size(); ++v) {
    by_device += static_cast<double>(squared_distance(truth_[v], error_[v]));
    alone += static_cast<double>(squared_distance(truth_[v], expected_[v]));
  }
  return by_device <= alone ? Following::kept : Following::none;
}

/// What the receiver shows, if it got every packet.
void MainEncoder::predict_shown(const EncodeRequest<MainState>& request) noexcept {
  const MainState& shown = request.shown;
  if (driven_) driven_->follow(request.tick);
  if (shown.following != Following::none && driven_ && driven_->show(shown, request.tick, expected_)) return;
  predictor_.predict(shown, request.tick, expected_);
}

/// A key packet forgets the whole shape, and so is due as soon as any bound is broken.
bool MainEncoder::bounds_hold(const EncodeRequest<MainState>& request) noexcept {
  predict_shown(request);
  for (std::uint32_t v = 0; v < truth_.size(); ++v) {
    if (!request.head.key && !coder_.codes(v)) continue;
    const std::int64_t bound = trigger_[coder_.is_inside(v)];
    if (squared_distance(truth_[v], expected_[v]) > bound * bound) return false;
  }
  return true;
}

void MainEncoder::choose_coefficients(const MainHead& head) noexcept {
  if (coefficients_.empty()) return;
  for (std::size_t v = 0; v < truth_.size(); ++v)
    for (std::size_t axis = 0; axis < 3; ++axis) error_[v][axis] = truth_[v][axis] - expected_[v][axis];
  projection_.project(error_, projected_);
  if (head.touched)
    area_fit_.improve(error_, {coder_.area(), static_cast<float>(limit_[1]), static_cast<float>(limit_[0])}, projected_);
  const std::uint32_t reach = mode_reach(head);
  for (std::size_t k = 0; k < coefficients_.size(); ++k) {
    const float steps = projected_[k] / static_cast<float>(coefficient_step(object_, reach, k));
    const float size = std::min(1e9F, std::abs(steps));
    const auto rounded = size >= kDeadZone ? static_cast<std::int32_t>(std::floor(size + 0.5F)) : 0;
    coefficients_[k] = steps < 0 ? -rounded : rounded;
  }
}

void MainEncoder::move_modes(const MainHead& head) noexcept {
  choose_coefficients(head);
  std::copy(coefficients_.begin(), coefficients_.end(), scaled_.begin());
  scale_coefficients(object_, mode_reach(head), scaled_);
  predictor_.add_modes(scaled_, expected_);
}

/// Quantise every vertex as the decoder will see it. Returns how many have a residual.
std::uint32_t MainEncoder::choose_residuals() noexcept {
  coded_.clear();
  std::uint32_t updates = 0;
  coder_.run(
      expected_, next_.displacement,
      [&](std::uint32_t v, const VertexContext& context, const auto& axes, const Vec3i& predicted, std::int64_t step) noexcept {
        const Vec3i residual = quantise(truth_[v], predicted, limit_[coder_.is_inside(v)], step, context.depth > 0);
        const bool any = !is_zero(residual);
        coded_.push_back({context, any ? axes() : AxisContexts{}, residual});
        updates += any ? 1u : 0u;
        return residual;
      });
  return updates;
}

std::size_t MainEncoder::write(MainHead head, const MainState& base, std::span<std::uint8_t> out) noexcept {
  RangeEncoder coder(out);
  MainModels models = main_start_models();
  code_main_start(coder, models, object_, baseline_span_, head);
  code_main_head(coder, models, object_, rings_, base, head);
  if (head.layer != Layer::haptic) code_coefficients(coder, models, coefficients_);
  for (CodedVertex& c : coded_)
    if (code_significance(coder, models, head.density, c.context, !is_zero(c.residual)))
      code_residual(coder, models, c.context, c.axes, c.residual);
  return coder.finish();
}

/// Residuals and payload with one set of weights.
Payload MainEncoder::write_vertices(MainHead& head, const MainState& base, std::span<std::uint8_t> out) noexcept {
  coder_.use_weights(head.weight_set);
  const std::uint32_t updates = choose_residuals();
  const std::uint64_t fraction = (std::uint64_t{updates} << 8) / coded_.size();
  head.density = head.layer == Layer::haptic ? base.density : fraction < 3 ? 0 : fraction < 15 ? 1 : fraction < 64 ? 2 : 3;
  return Payload{.size = write(head, base, out), .updates = updates};
}

/// The shortest payload of all sets of weights. The baseline's set comes last: it is mostly the best, and then not written again.
Payload MainEncoder::write_shortest(MainHead& head, const MainState& base, std::span<std::uint8_t> out) noexcept {
  const auto sets = static_cast<std::uint32_t>(hierarchy_->parents.size());
  std::size_t least = out.size() + 1;
  std::uint32_t best = base.weight_set;
  for (std::uint32_t i = 1; i < sets; ++i) {
    head.weight_set = (base.weight_set + i) % sets;
    const std::size_t size = write_vertices(head, base, out).size;
    if (size >= least) continue;
    least = size;
    best = head.weight_set;
  }
  head.weight_set = base.weight_set;
  const Payload last = write_vertices(head, base, out);
  if (last.size <= least) return last;
  head.weight_set = best;
  return write_vertices(head, base, out);
}

Result<Payload> MainEncoder::encode(const EncodeRequest<MainState>& request, std::span<std::uint8_t> out) noexcept {
  MainHead head = head_for(request);
  if (head.layer == Layer::haptic && !head.touched) return Payload{};
  coder_.set_packet(head, rings_, object_.rings);
  if (!request.requested && bounds_hold(request)) return Payload{};
  // What is rendered goes first: a key packet of the rest alone would forget it.
  if (head.layer == Layer::visual && head.key && head.touched) return Payload{};
  const MainState& base = request.base;
  head.following = choose_following(request);
  // Without an own motion of what is shown, bounds_hold() has just predicted the same.
  if (&base != &request.shown || request.requested || driven_) predictor_.predict(base, request.tick, expected_);
  coder_.fade(object_, base, request.tick, expected_, next_);
  if (object_.layered) coder_.begin_layer(base, head.same_frame, expected_, next_.displacement);
  if (head.layer == Layer::haptic) {
    keep_motion(base, next_);
  } else {
    move_modes(head);
    predictor_.update(base, request.tick, next_);
  }
  const Payload payload = write_shortest(head, base, out);
  coder_.keep_off_basis(base, head.same_frame, next_);
  coder_.keep_haptic_correction(head.layer, next_);
  keep_head(head, base, next_);
  return payload;
}

// ==== deformable encoder ====

namespace {

/// The rule that a touch breaks, or none.
RuleName broken_rule(const SurfaceTouch& touch, std::size_t triangles) noexcept {
  if (!std::isfinite(touch.force) || !std::isfinite(touch.stiffness)) return "R-API-1";
  if (touch.triangle >= triangles || touch.force < 0 || !(touch.stiffness > 0)) return "R-API-15";
  return {};
}

}  // namespace

ShapeTruth::ShapeTruth(const Scene& scene, std::uint32_t object, HeldList& held)
    : held_(held),
      object_(object),
      triangles_(scene.deformables[object].triangles.size()),
      position_exp_(scene.grid.position),
      shape_(scene.deformables[object].rest.size()),
      next_(shape_.size()) {}

void ShapeTruth::read(std::int64_t tick, const DeformableTruth* truth) noexcept {
  is_new_ = truth != nullptr && !truth->displacements.empty();
  if (!is_new_) {
    held_.keep(TruthPart::shape, object_);
    held_.keep(TruthPart::touch, object_);
    return;
  }
  const auto hold = [&](TruthPart part, const char* rule) { held_.hold({part, object_, tick, rule}); };
  if (const auto on_grid = to_grid(truth->displacements, position_exp_, next_)) std::swap(shape_, next_);
  else hold(TruthPart::shape, on_grid.error().rule);
  touch_ = truth->touch;
  if (!touch_) return;
  if (const RuleName rule = broken_rule(*touch_, triangles_)) {
    touch_.reset();
    hold(TruthPart::touch, rule);
  }
}

std::size_t max_packet(const Scene& scene, const DeformableObject& object) noexcept {
  if (object.profile == DeformableProfile::thesis) return scene.thesis()->largest_packet(object);
  return max_main_packet(object.rest.size(), object.basis.steps.size());
}

Result<void> DeformableEncoder::check(const DeformableOptions& options) noexcept {
  const auto in = [](double v, double low, double high) { return v >= low && v <= high; };  // false for NaN
  const DeformableThresholds& t = options.thresholds;
  if (in(t.visual, 0, 1e6) && in(t.weber_fraction.value_or(0), 0, 1) && in(t.depth_floor, 0, 1e6) &&
      in(options.visual_fraction.value_or(1), 1e-3, 1) && in(options.haptic_fraction.value_or(1), 1e-3, 1))
    return {};
  return fail(Errc::invalid_argument, "R-API-4");
}

std::unique_ptr<DeformableEncoder> DeformableEncoder::create(const Scene& scene, std::size_t object,
                                                             const DeformableOptions& options, const SenderPolicy& policy,
                                                             std::unique_ptr<FollowedShape> driven) {
  const DeformableObject& o = scene.deformables[object];
  if (o.profile == DeformableProfile::thesis) return scene.thesis()->encoder(scene, object, options, policy);
  return std::make_unique<DeformableEncoderOf<MainEncoder>>(scene, object, options, policy, max_packet(scene, o), o.layered,
                                                            initial_main_state(o), std::move(driven));
}

}  // namespace tactus
