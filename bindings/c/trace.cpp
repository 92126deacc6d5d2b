// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <system_error>

#include <tactus/scene/scene_syntax.h>
#include <tactus/thesis/if_built.h>
#include <tactus/trace/trace_scene.h>

#include "bounds.h"
#include "trace_handle.h"

namespace tactus::c {
namespace {

constexpr tactus_trace_coding kCoding{.size = sizeof(tactus_trace_coding),
                                      .rigid_profile = TACTUS_PROFILE_MAIN,
                                      .deformable_profile = TACTUS_PROFILE_MAIN,
                                      .baselines = 1,
                                      .spring_modes = 0,
                                      .clusters = 0,
                                      .rigid = nullptr,
                                      .deformable = nullptr,
                                      .world_size = 0};

Result<const TraceDeformable*> mesh_of(const tactus_trace* trace, std::uint32_t mesh) noexcept {
  TACTUS_TRY(const TraceInfo* info, info_of(trace));
  if (mesh >= info->meshes.size()) return refuse();
  return &info->meshes[mesh];
}

tactus_rigid_sample sample_of(const RigidSample& s) noexcept {
  const auto& [pose, v, w] = s;
  return {.pose = pose_of(pose), .velocity = {v.x, v.y, v.z}, .angular_velocity = {w.x, w.y, w.z}};
}

std::uint32_t bits_of(const DeviceSenses& senses) noexcept {
  return (senses.orientation ? 1u : 0) | (senses.velocity ? 2u : 0) | (senses.buttons ? 4u : 0) | (senses.time ? 8u : 0);
}

std::uint32_t bits_of(RecordedForces forces) noexcept {
  if (forces == RecordedForces::both) return TACTUS_FORCE_RENDERED | TACTUS_FORCE_SERVER;
  return forces == RecordedForces::rendered ? TACTUS_FORCE_RENDERED : TACTUS_FORCE_SERVER;
}

static_assert(sizeof(Vec3) == 3 * sizeof(double), "handed out as three numbers");

void put(const Vec3& v, double (&out)[3]) noexcept {
  out[0] = v.x;
  out[1] = v.y;
  out[2] = v.z;
}

tactus_user_sample sample_of(const UserSample& s) noexcept {
  tactus_user_sample out{};
  put(s.device.position, out.device.position);
  const auto& [qw, qx, qy, qz] = s.device.orientation;
  out.device.orientation[0] = qw;
  out.device.orientation[1] = qx;
  out.device.orientation[2] = qy;
  out.device.orientation[3] = qz;
  put(s.device.velocity, out.device.velocity);
  out.device.buttons = s.device.buttons;
  out.device.time = s.device.time;
  out.contact.kind = static_cast<std::int32_t>(s.contact.kind);
  out.contact.object = s.contact.object;
  put(s.contact.point, out.contact.point);
  put(s.contact.normal, out.contact.normal);
  put(s.contact.device, out.contact.device);
  out.contact.stiffness = s.contact.stiffness;
  put(s.force, out.force);
  put(s.server_force, out.server_force);
  if (!s.surface_contact) return out;
  const SurfaceContact& touch = *s.surface_contact;
  out.touches_mesh = 1;
  out.mesh = touch.mesh;
  out.triangle = touch.triangle;
  for (std::size_t i = 0; i < 3; ++i) out.weights[i] = touch.weights[i];
  put(touch.proxy, out.proxy);
  put(touch.normal, out.mesh_normal);
  out.mesh_stiffness = touch.stiffness;
  return out;
}

/// Copy to the caller's array, which has room for all or is not wanted.
template <class From, class To>
void copy_samples(const std::vector<From>& from, To* to, std::size_t count) noexcept {
  if (count == 0) return;
  for (const From& sample : from) *to++ = sample_of(sample);
}

/// err  R-TRC-1 it is no file that can be read once more; those of find_clusters()
Result<std::map<std::string, ClusterBasis>> clusters_of(const tactus_trace& trace, std::size_t most) {
  if (most == 0) return {};
  if (trace.path.empty()) {
    TACTUS_TRY(TraceReader reader, TraceReader::open_memory(trace.bytes));
    return find_clusters(reader, most);
  }
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(trace.path, ignored)) return fail(Errc::io, "R-TRC-1");
  TACTUS_TRY(TraceReader reader, TraceReader::open(trace.path));
  return find_clusters(reader, most);
}

Result<std::vector<std::uint8_t>> declaration(const tactus_trace& trace, const tactus_trace_coding& coding) {
  if (coding.rigid_profile > TACTUS_PROFILE_MAIN || coding.deformable_profile > TACTUS_PROFILE_MAIN || coding.baselines > 0xff ||
      coding.spring_modes > ModeBasis::kMaxModes)
    return fail(Errc::invalid_argument, "R-API-4");
  TACTUS_TRY(const RigidTriggers rigid, bounds_of(coding.rigid));
  TACTUS_TRY(const DeformableThresholds deformable, bounds_of(coding.deformable));
  TACTUS_TRY(auto clusters, clusters_of(trace, coding.clusters));
  TraceFrame none;
  none.objects.resize(trace.reader.info().objects.size());
  const TraceFrame& first = trace.has_frame ? trace.frame : none;
  TACTUS_TRY(SceneBuilder builder,
             scene_builder(trace.reader.info(), first,
                           {.deformable = {.profile = static_cast<DeformableProfile>(coding.deformable_profile)},
                            .spring_modes = static_cast<std::uint8_t>(coding.spring_modes),
                            .basis = {},
                            .clusters = std::move(clusters),
                            .rigid = static_cast<RigidProfile>(coding.rigid_profile)}));
  builder.baselines(static_cast<std::uint8_t>(coding.baselines)).declare_bounds(rigid, deformable);
  if (coding.world_size != 0) builder.world_size(coding.world_size);
  TACTUS_TRY(const SharedScene scene, std::move(builder).build({.thesis = thesis_if_built()}));
  return write_scene(*scene);
}

/// The next frame; an error with its words.   in  path  empty: memory
Result<void> read_frame(tactus_trace& trace) {
  const auto more = trace.reader.next(trace.frame);
  trace.has_frame = more.value_or(false);
  if (more) return {};
  Diagnostic error = trace.reader.explain(more.error());
  error.file = trace.path;
  return keep_words(error);
}

/// A trace at its first frame, for the caller.
Outcome hand_out(tactus_trace made, tactus_trace** trace) {
  auto out = std::make_unique<tactus_trace>(std::move(made));
  TACTUS_CHECK(read_frame(*out));
  *trace = out.release();
  return TACTUS_OK;
}

}  // namespace

std::string& error_words() noexcept {
  static thread_local std::string words;
  return words;
}

tl::unexpected<Error> keep_words(const Diagnostic& error) {
  const bool says_more = !location_of(error).empty() || !error.cause.empty() || !error.remedy.empty();
  if (says_more) error_words() = to_string(error);
  return tl::unexpected(error.error);
}

}  // namespace tactus::c

using namespace tactus;
using namespace tactus::c;

tactus_status tactus_trace_init(int32_t kind, void* options, size_t size) {
  switch (kind) {
    case TACTUS_TRACE_CODING:
      return init(static_cast<tactus_trace_coding*>(options), size, kCoding);
    case TACTUS_ERRORS_OPTIONS:
      return init(static_cast<tactus_errors_options*>(options), size, defaults<tactus_errors_options>());
    default:
      return TACTUS_INVALID_ARGUMENT;
  }
}

tactus_status tactus_trace_open(const char* path, const uint8_t* bytes, size_t size, tactus_trace** trace, tactus_error* error) {
  return call_with_words(error, [&]() -> Outcome {
    TACTUS_TRY(const auto all, span_of(bytes, size));
    if (trace == nullptr || (path == nullptr && bytes == nullptr)) return refuse();
    auto reader = path != nullptr ? TraceReader::open(path, {}) : TraceReader::open_memory(all, {});
    if (!reader) return keep_words(reader.error());
    return hand_out({.reader = *std::move(reader), .path = path != nullptr ? path : "", .bytes = all}, trace);
  });
}

void tactus_trace_destroy(tactus_trace* trace) { delete trace; }

tactus_status tactus_trace_get(const tactus_trace* trace, tactus_trace_info* info, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(const TraceInfo* of, info_of(trace));
    TACTUS_CHECK(check_answer(info));
    const auto frames = trace->reader.frame_count();
    answer(info, {.size = 0,
                  .tick_rate = of->tick_rate,
                  .objects = static_cast<std::uint32_t>(of->objects.size()),
                  .users = static_cast<std::uint32_t>(of->users.size()),
                  .meshes = static_cast<std::uint32_t>(of->meshes.size()),
                  .has_frames = frames.has_value(),
                  .frames = frames.value_or(0),
                  .source = of->source.c_str(),
                  .cut_short = trace->reader.cut_short(),
                  .reserved = 0});
    return TACTUS_OK;
  });
}

tactus_status tactus_trace_get_object(const tactus_trace* trace, uint32_t object, tactus_trace_object* info,
                                      tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(const TraceInfo* of, info_of(trace));
    if (object >= of->objects.size()) return refuse();
    TACTUS_CHECK(check_answer(info));
    answer(info, {.size = 0, .dof = of->objects[object].dof, .name = of->objects[object].name.c_str()});
    return TACTUS_OK;
  });
}

tactus_status tactus_trace_get_user(const tactus_trace* trace, uint32_t user, tactus_trace_user* info, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(const TraceInfo* of, info_of(trace));
    if (user >= of->users.size()) return refuse();
    TACTUS_CHECK(check_answer(info));
    const TraceUser& out = of->users[user];
    answer(info,
           {.size = 0, .senses = bits_of(out.senses), .name = out.name.c_str(), .forces = bits_of(out.forces), .reserved = 0});
    return TACTUS_OK;
  });
}

tactus_status tactus_trace_get_mesh(const tactus_trace* trace, uint32_t mesh, tactus_trace_mesh* info, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(const TraceDeformable* of, mesh_of(trace, mesh));
    TACTUS_CHECK(check_answer(info));
    answer(info, {.size = 0,
                  .vertices = static_cast<std::uint32_t>(of->rest.vertices.size()),
                  .triangles = static_cast<std::uint32_t>(of->rest.triangles.size()),
                  .fixed = static_cast<std::uint32_t>(of->fixed.size()),
                  .period = of->period,
                  .name = of->name.c_str(),
                  .rest = of->rest.vertices.empty() ? nullptr : &of->rest.vertices[0].x,
                  .corners = of->rest.triangles.empty() ? nullptr : of->rest.triangles[0].data()});
    return TACTUS_OK;
  });
}

tactus_status tactus_trace_scene(const tactus_trace* trace, const tactus_trace_coding* coding, uint8_t* bytes, size_t capacity,
                                 size_t* size, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (trace == nullptr || !trace->is_first) return refuse();
    TACTUS_TRY(const tactus_trace_coding chosen, given_or(coding, kCoding));
    TACTUS_TRY(const std::vector<std::uint8_t> written, declaration(*trace, chosen));
    return copy_out(std::span(written), bytes, capacity, size);
  });
}

tactus_status tactus_trace_next(tactus_trace* trace, int64_t* tick, tactus_rigid_sample* objects, size_t object_count,
                                tactus_user_sample* users, size_t user_count, tactus_error* error) {
  return call_with_words(error, [&]() -> Outcome {
    if (trace == nullptr || tick == nullptr) return refuse();
    const TraceInfo& info = trace->reader.info();
    const auto fits = [](std::size_t count, std::size_t all, const void* out) {
      return count == 0 || (count == all && out != nullptr);
    };
    if (!fits(object_count, info.objects.size(), objects) || !fits(user_count, info.users.size(), users)) return refuse();
    if (!trace->has_frame) return TACTUS_NOTHING;
    if (!trace->is_first) TACTUS_CHECK(read_frame(*trace));
    trace->is_first = false;
    if (!trace->has_frame) return TACTUS_NOTHING;
    *tick = trace->frame.tick;
    copy_samples(trace->frame.objects, objects, object_count);
    copy_samples(trace->frame.users, users, user_count);
    return TACTUS_OK;
  });
}

tactus_status tactus_trace_shape(const tactus_trace* trace, uint32_t mesh, tactus_shape* shape, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_TRY(const TraceFrame* frame, frame_of(trace));
    if (mesh >= frame->meshes.size() || shape == nullptr) return refuse();
    const DeformableSample& of = frame->meshes[mesh];
    const auto touch = touch_of(*frame, mesh);
    *shape = {.displacements = of.updated ? of.displacements.data() : nullptr,
              .vertices = of.displacements.size() / 3,
              .touched = touch.has_value(),
              .triangle = touch ? touch->triangle : 0,
              .force = touch ? touch->force : 0,
              .stiffness = touch ? touch->stiffness : 0};
    return TACTUS_OK;
  });
}
