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
          .worst_ratio = 0};
}

/// The truth to compare with.   err  R-API-12 no frame; R-API-5 of another scene
Result<const TraceFrame*> truth_of(const tactus_errors* errors, const tactus_trace* trace) noexcept {
  if (errors == nullptr) return refuse();
  TACTUS_TRY(const TraceFrame* frame, frame_of(trace));
  if (frame->objects.size() != errors->shown.size() || frame->meshes.size() != errors->meshes.size())
    return fail(Errc::invalid_argument, "R-API-5");
  return frame;
}

}  // namespace
}  // namespace tactus::c

using namespace tactus;
using namespace tactus::c;

tactus_status tactus_errors_options_init(tactus_errors_options* options, size_t size) {
  return init(options, size, errors_options());
}

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

tactus_status tactus_errors_add(tactus_errors* errors, const tactus_trace* truth, const tactus_pose* shown, size_t count,
                                tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(const TraceFrame* frame, truth_of(errors, truth));
    TACTUS_TRY(const auto poses, span_of(shown, count));
    if (poses.size() != errors->shown.size()) return fail(Errc::invalid_argument, "R-API-5");
    for (std::size_t i = 0; i < poses.size(); ++i) errors->shown[i] = pose_of(poses[i]);
    errors->rigid.add(*frame, errors->shown);
    return TACTUS_OK;
  });
}

tactus_status tactus_errors_add_shape(tactus_errors* errors, const tactus_trace* truth, uint32_t mesh, const float* shown,
                                      size_t vertices, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(const TraceFrame* frame, truth_of(errors, truth));
    if (mesh >= errors->meshes.size() || shown == nullptr) return refuse();
    const std::size_t all = errors->vertices[mesh];
    if (vertices != all || frame->meshes[mesh].displacements.size() != 3 * all) return fail(Errc::invalid_argument, "R-API-5");
    if (!frame->meshes[mesh].updated) return TACTUS_NOTHING;
    errors->meshes[mesh].add(frame->meshes[mesh].displacements, std::span(shown, 3 * vertices), touch_of(*frame, mesh));
    return TACTUS_OK;
  });
}

tactus_status tactus_errors_get(const tactus_errors* errors, uint32_t quantity, tactus_error_summary* summary,
                                tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (errors == nullptr || quantity > TACTUS_ERROR_PERCEIVED) return refuse();
    TACTUS_CHECK(check_answer(summary));
    const ErrorMetrics& rigid = errors->rigid;
    const ErrorSeries* series[] = {&rigid.position(), &rigid.rotation(), &rigid.force(), &rigid.perceived()};
    tactus_error_summary out = summary_of(*series[quantity]);
    if (quantity == TACTUS_ERROR_FORCE) out.worst_ratio = rigid.worst_haptic_ratio();
    answer(summary, out);
    return TACTUS_OK;
  });
}

tactus_status tactus_errors_get_mesh(const tactus_errors* errors, uint32_t mesh, tactus_mesh_summary* summary,
                                     tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (errors == nullptr || mesh >= errors->meshes.size()) return refuse();
    TACTUS_CHECK(check_answer(summary));
    const DeformableErrors& of = errors->meshes[mesh];
    answer(summary, {.size = 0,
                     .reserved = 0,
                     .frames = of.frames(),
                     .vertices = of.all().vertices,
                     .violations = of.all().violations,
                     .rms = std::sqrt(of.all().mse()),
                     .max = of.all().max,
                     .worst_ratio = of.worst_ratio()});
    return TACTUS_OK;
  });
}
