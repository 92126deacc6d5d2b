// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <memory>
#include <vector>

#include <tactus/metrics/deformable_errors.h>
#include <tactus/metrics/errors.h>
#include <tactus/trace/trace_scene.h>

#include "bounds.h"
#include "trace_handle.h"

struct tactus_errors {
  tactus::ErrorMetrics rigid;
  std::vector<tactus::DeformableErrors> meshes{};
  std::vector<std::size_t> vertices{};  // of each mesh
  std::vector<tactus::Pose> shown{};
};

namespace tactus::c {
namespace {

tactus_errors_options errors_options() noexcept {
  return {.size = sizeof(tactus_errors_options),
          .rings = DeformableCoding{}.rings,
          .position_exp = GridExponents{}.position,
          .reserved = 0,
          .rigid = nullptr,
          .deformable = nullptr};
}

tactus_error_summary summary_of(const ErrorSeries& series) noexcept {
  return {.size = 0,
          .reserved = 0,
          .ticks = series.ticks(),
          .ticks_over = series.ticks_over(),
          .longest_run = series.longest_run(),
          .rms = series.rms(),
          .max = series.max(),
          .worst_ratio = 0,
          .vertices = 0,
          .violations = 0};
}

/// The truth to compare with.   err  R-API-12 no frame; R-API-5 of another scene
Result<const TraceFrame*> truth_of(const tactus_errors* errors, const tactus_trace* trace) noexcept {
  if (errors == nullptr) return refuse();
  TACTUS_TRY(const TraceFrame* frame, frame_of(trace));
  if (frame->objects.size() != errors->shown.size() || frame->meshes.size() != errors->meshes.size())
    return fail(Errc::invalid_argument, "R-API-5");
  return frame;
}

tactus_error_summary summary_of(const DeformableErrors& mesh) noexcept {
  tactus_error_summary out{};
  out.ticks = mesh.frames();
  out.rms = std::sqrt(mesh.all().mse());
  out.max = mesh.all().max;
  out.worst_ratio = mesh.worst_ratio();
  out.vertices = mesh.all().vertices;
  out.violations = mesh.all().violations;
  return out;
}

}  // namespace

template <>
tactus_errors_options defaults<tactus_errors_options>() noexcept {
  return errors_options();
}

}  // namespace tactus::c

using namespace tactus;
using namespace tactus::c;

tactus_status tactus_errors_create(const tactus_trace* truth, const tactus_errors_options* options, tactus_errors** errors,
                                   tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(const TraceInfo* info, info_of(truth));
    if (errors == nullptr) return refuse();
    TACTUS_TRY(const tactus_errors_options o, given_or(options, errors_options()));
    TACTUS_TRY(const RigidTriggers rigid, bounds_of(o.rigid));
    TACTUS_TRY(const DeformableThresholds deformable, bounds_of(o.deformable));
    if (o.rings > DeformableObject::kMaxRings || o.position_exp > 30) return fail(Errc::invalid_argument, "R-API-4");
    auto out = std::make_unique<tactus_errors>(tactus_errors{ErrorMetrics(*info, rigid)});
    out->shown.resize(info->objects.size());
    for (const TraceDeformable& mesh : info->meshes) {
      out->meshes.emplace_back(mesh.rest, deformable, static_cast<std::uint8_t>(o.rings), o.position_exp);
      out->vertices.push_back(mesh.rest.vertices.size());
    }
    *errors = out.release();
    return TACTUS_OK;
  });
}

void tactus_errors_destroy(tactus_errors* errors) { delete errors; }

tactus_status tactus_errors_add(tactus_errors* errors, const tactus_trace* truth, const tactus_pose* poses, size_t pose_count,
                                const tactus_shape* shapes, size_t shape_count, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(const TraceFrame* frame, truth_of(errors, truth));
    TACTUS_TRY(const auto shown, span_of(poses, pose_count));
    TACTUS_TRY(const auto forms, span_of(shapes, shape_count));
    if ((poses != nullptr && shown.size() != errors->shown.size()) ||
        (shapes != nullptr && forms.size() != errors->meshes.size()))
      return fail(Errc::invalid_argument, "R-API-5");
    for (std::size_t i = 0; i < forms.size(); ++i) {
      const std::size_t all = errors->vertices[i];
      if (forms[i].displacements != nullptr && (forms[i].vertices != all || frame->meshes[i].displacements.size() != 3 * all))
        return fail(Errc::invalid_argument, "R-API-5");
    }
    for (std::size_t i = 0; i < shown.size(); ++i) errors->shown[i] = pose_of(shown[i]);
    if (poses != nullptr) errors->rigid.add(*frame, errors->shown);
    for (std::size_t i = 0; i < forms.size(); ++i) {
      const DeformableSample& mesh = frame->meshes[i];
      if (forms[i].displacements == nullptr || !mesh.updated) continue;
      errors->meshes[i].add(mesh.displacements, std::span(forms[i].displacements, mesh.displacements.size()),
                            touch_of(*frame, i));
    }
    return TACTUS_OK;
  });
}

tactus_status tactus_errors_get(const tactus_errors* errors, uint32_t quantity, uint32_t mesh, tactus_error_summary* summary,
                                tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (errors == nullptr || quantity > TACTUS_ERROR_SHAPE) return refuse();
    if (quantity == TACTUS_ERROR_SHAPE && mesh >= errors->meshes.size()) return refuse();
    TACTUS_CHECK(check_answer(summary));
    if (quantity == TACTUS_ERROR_SHAPE) {
      answer(summary, summary_of(errors->meshes[mesh]));
      return TACTUS_OK;
    }
    const ErrorMetrics& rigid = errors->rigid;
    const ErrorSeries* series[] = {&rigid.position(), &rigid.rotation(), &rigid.force(), &rigid.perceived()};
    tactus_error_summary out = summary_of(*series[quantity]);
    if (quantity == TACTUS_ERROR_FORCE) out.worst_ratio = rigid.worst_haptic_ratio();
    answer(summary, out);
    return TACTUS_OK;
  });
}
