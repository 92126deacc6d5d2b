// SPDX-License-Identifier: Apache-2.0
#include <tactus/trace/trace_file.h>

#include <memory>
#include <string>

#include "handles.h"

struct tactus_trace_writer {
  std::string path;
  tactus::TraceInfo info{};
  std::optional<tactus::TraceWriter> writer{};  // from the first tick on
  tactus::TraceFrame frame{};
};

using namespace tactus;
using namespace tactus::c;

namespace {

/// err  R-API-12 null; R-API-5 a tick was added
Outcome check_describing(const tactus_trace_writer* writer, const char* name) noexcept {
  if (writer == nullptr || name == nullptr) return refuse();
  if (writer->writer) return fail(Errc::invalid_argument, "R-API-5");
  return TACTUS_OK;
}

DeviceSenses senses_of(std::uint32_t bits) noexcept {
  return {.orientation = (bits & 1u) != 0, .velocity = (bits & 2u) != 0, .buttons = (bits & 4u) != 0, .time = (bits & 8u) != 0};
}

UserSample sample_of(const tactus_user_sample& s) noexcept {
  const double* q = s.device.orientation;
  UserSample out;
  out.device.position = vec_of(s.device.position);
  out.device.orientation = {q[0], q[1], q[2], q[3]};
  out.device.velocity = vec_of(s.device.velocity);
  out.device.buttons = s.device.buttons;
  out.device.time = s.device.time;
  out.contact = {.kind = static_cast<ContactKind>(s.contact.kind),
                 .object = s.contact.object,
                 .point = vec_of(s.contact.point),
                 .normal = vec_of(s.contact.normal),
                 .device = out.device.position,
                 .stiffness = s.contact.stiffness};
  out.force = vec_of(s.force);
  out.server_force = vec_of(s.server_force);
  if (s.touches_mesh != 0)
    out.surface_contact = SurfaceContact{.mesh = s.mesh,
                                         .triangle = s.triangle,
                                         .weights = {s.weights[0], s.weights[1], s.weights[2]},
                                         .proxy = vec_of(s.proxy),
                                         .normal = vec_of(s.mesh_normal),
                                         .stiffness = s.mesh_stiffness};
  return out;
}

/// err  R-API-5 another number of vertices
Result<void> take(const tactus_shape& shape, const TraceDeformable& mesh, DeformableSample& out) {
  out.updated = shape.displacements != nullptr;
  if (!out.updated) return {};
  if (shape.vertices != mesh.rest.vertices.size()) return fail(Errc::invalid_argument, "R-API-5");
  out.displacements.assign(shape.displacements, shape.displacements + 3 * shape.vertices);
  return {};
}

}  // namespace

tactus_status tactus_trace_writer_create(const char* path, uint32_t tick_rate, const char* source, tactus_trace_writer** writer,
                                         tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (path == nullptr || writer == nullptr) return refuse();
    auto out = std::make_unique<tactus_trace_writer>();
    out->path = path;
    out->info.tick_rate = tick_rate;
    if (source != nullptr) out->info.source = source;
    *writer = out.release();
    return TACTUS_OK;
  });
}

void tactus_trace_writer_destroy(tactus_trace_writer* writer) { delete writer; }

tactus_status tactus_trace_writer_object(tactus_trace_writer* writer, const char* name, uint32_t dof, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_CHECK(check_describing(writer, name));
    if (dof > Dof::all) return fail(Errc::invalid_argument, "R-API-4");
    writer->info.objects.push_back({name, static_cast<std::uint8_t>(dof)});
    return TACTUS_OK;
  });
}

tactus_status tactus_trace_writer_user(tactus_trace_writer* writer, const char* name, uint32_t senses, uint32_t forces,
                                       tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_CHECK(check_describing(writer, name));
    if (senses > 15 || forces == 0 || forces > 3) return fail(Errc::invalid_argument, "R-API-4");
    const RecordedForces known = forces == TACTUS_FORCE_RENDERED     ? RecordedForces::rendered
                              : forces == TACTUS_FORCE_SERVER ? RecordedForces::server
                                                              : RecordedForces::both;
    writer->info.users.push_back({.name = name, .senses = senses_of(senses), .forces = known});
    return TACTUS_OK;
  });
}

tactus_status tactus_trace_writer_mesh(tactus_trace_writer* writer, const char* name, const double* vertices, size_t vertex_count,
                                       const uint32_t* triangles, size_t triangle_count, double period, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    TACTUS_CHECK(check_describing(writer, name));
    TACTUS_CHECK(span_of(vertices, vertex_count));
    TACTUS_CHECK(span_of(triangles, triangle_count));
    if (vertex_count > kMaxMeshVertices) return fail(Errc::invalid_argument, "R-API-5");
    TraceDeformable mesh{.name = name, .rest = {}, .period = period};
    for (std::size_t i = 0; i < vertex_count; ++i)
      mesh.rest.vertices.push_back({vertices[3 * i], vertices[3 * i + 1], vertices[3 * i + 2]});
    for (std::size_t i = 0; i < triangle_count; ++i)
      mesh.rest.triangles.push_back({triangles[3 * i], triangles[3 * i + 1], triangles[3 * i + 2]});
    writer->info.meshes.push_back(std::move(mesh));
    return TACTUS_OK;
  });
}

tactus_status tactus_trace_writer_add(tactus_trace_writer* writer, int64_t tick, const tactus_rigid_sample* objects,
                                      size_t object_count, const tactus_user_sample* users, size_t user_count,
                                      const tactus_shape* shapes, size_t shape_count, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (writer == nullptr) return refuse();
    TACTUS_TRY(const auto bodies, span_of(objects, object_count));
    TACTUS_TRY(const auto hands, span_of(users, user_count));
    TACTUS_TRY(const auto forms, span_of(shapes, shape_count));
    TraceInfo& info = writer->info;
    if (bodies.size() != info.objects.size() || hands.size() != info.users.size() || forms.size() != info.meshes.size())
      return fail(Errc::invalid_argument, "R-API-5");
    TraceFrame& frame = writer->frame;
    frame.tick = tick;
    frame.objects.clear();
    for (const tactus_rigid_sample& s : bodies)
      frame.objects.push_back({pose_of(s.pose), vec_of(s.velocity), vec_of(s.angular_velocity)});
    frame.users.clear();
    for (const tactus_user_sample& s : hands) {
      if (s.contact.kind < TACTUS_CONTACT_NONE || s.contact.kind > TACTUS_CONTACT_SPRING)
        return fail(Errc::invalid_argument, "R-API-5");
      frame.users.push_back(sample_of(s));
    }
    frame.meshes.resize(forms.size());
    for (std::size_t i = 0; i < forms.size(); ++i) {
      TACTUS_CHECK(take(forms[i], info.meshes[i], frame.meshes[i]));
      if (frame.meshes[i].displacements.empty()) frame.meshes[i].displacements.resize(3 * info.meshes[i].rest.vertices.size());
    }
    if (!writer->writer) {
      TACTUS_TRY(writer->writer, TraceWriter::create(writer->path, info));
    }
    TACTUS_CHECK(writer->writer->write(frame));
    return TACTUS_OK;
  });
}

tactus_status tactus_trace_writer_finish(tactus_trace_writer* writer, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (writer == nullptr) return refuse();
    if (!writer->writer) return fail(Errc::invalid_argument, "R-API-5");
    TACTUS_CHECK(writer->writer->finish());
    return TACTUS_OK;
  });
}
