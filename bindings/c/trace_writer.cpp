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

/// err  R-API-12 no name; R-API-4 no such axis
Result<TraceObject> declared(const tactus_trace_object& object) {
  TACTUS_TRY(const tactus_trace_object o, given_or(&object, tactus_trace_object{}));
  if (o.name == nullptr) return refuse();
  if (o.dof > Dof::all) return fail(Errc::invalid_argument, "R-API-4");
  return TraceObject{o.name, static_cast<std::uint8_t>(o.dof)};
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

/// err  R-API-12 no name; R-API-4 no such bit, or no force
Result<TraceUser> declared(const tactus_trace_user& user) {
  TACTUS_TRY(const tactus_trace_user u, given_or(&user, tactus_trace_user{}));
  if (u.name == nullptr) return refuse();
  if (u.senses > 15 || u.forces == 0 || u.forces > 3) return fail(Errc::invalid_argument, "R-API-4");
  const RecordedForces recorded = u.forces == TACTUS_FORCE_RENDERED ? RecordedForces::rendered
                                  : u.forces == TACTUS_FORCE_SERVER ? RecordedForces::server
                                                                    : RecordedForces::both;
  return TraceUser{.name = u.name, .senses = senses_of(u.senses), .forces = recorded};
}

/// err  R-API-12 no name or array; R-API-5 too many vertices
Result<TraceDeformable> declared(const tactus_trace_mesh& mesh) {
  TACTUS_TRY(const tactus_trace_mesh m, given_or(&mesh, tactus_trace_mesh{}));
  if (m.name == nullptr) return refuse();
  TACTUS_CHECK(span_of(m.rest, m.vertices));
  TACTUS_CHECK(span_of(m.corners, m.triangles));
  if (m.vertices > kMaxMeshVertices || m.triangles > kMaxMeshTriangles) return fail(Errc::invalid_argument, "R-API-5");
  TraceDeformable out{.name = m.name, .rest = {}, .period = m.period};
  for (std::size_t i = 0; i < m.vertices; ++i) out.rest.vertices.push_back({m.rest[3 * i], m.rest[3 * i + 1], m.rest[3 * i + 2]});
  for (std::size_t i = 0; i < m.triangles; ++i)
    out.rest.triangles.push_back({m.corners[3 * i], m.corners[3 * i + 1], m.corners[3 * i + 2]});
  return out;
}

/// Add what was declared, if anything.
template <class T>
void add(std::optional<T>& declared, std::vector<T>& to) {
  if (declared) to.push_back(*std::move(declared));
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

tactus_status tactus_trace_writer_declare(tactus_trace_writer* writer, const tactus_trace_object* object,
                                          const tactus_trace_user* user, const tactus_trace_mesh* mesh, tactus_error* error) {
  return call(error, [&]() -> Outcome {
    if (writer == nullptr) return refuse();
    if (writer->writer) return fail(Errc::invalid_argument, "R-API-5");
    std::optional<TraceObject> one_object;
    std::optional<TraceUser> one_user;
    std::optional<TraceDeformable> one_mesh;
    if (object != nullptr) {
      TACTUS_TRY(one_object, declared(*object));
    }
    if (user != nullptr) {
      TACTUS_TRY(one_user, declared(*user));
    }
    if (mesh != nullptr) {
      TACTUS_TRY(one_mesh, declared(*mesh));
    }
    add(one_object, writer->info.objects);
    add(one_user, writer->info.users);
    add(one_mesh, writer->info.meshes);
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
