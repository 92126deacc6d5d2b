// SPDX-License-Identifier: Apache-2.0
#include "cli/report/info.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <ctime>
#include <vector>

#include "cli/report/json.h"
#include "cli/report/report.h"
#include "cli/report/table.h"

#ifdef TACTUS_HAS_SIM
#include <tactus/sim/scene/scene.h>
#endif

namespace tactus::cli {

namespace {

constexpr const char* kSchema = "tactus.info/3";
constexpr std::array kElasticMethods{"backward Euler", "TR-BDF2", "velocity Verlet"};

Json vector_json(const Vec3& v) { return Json::array({v.x, v.y, v.z}); }

Json dof_json(std::uint8_t dof) {
  Json out = Json::array();
  for (std::size_t i = 0; i < kDofNames.size(); ++i)
    if (dof >> i & 1u) out.push_back(kDofNames[i]);
  return out;
}

double step_of(std::uint8_t exponent) { return 1.0 / static_cast<double>(std::uint64_t{1} << exponent); }

/// Range of the stiffness of the vertices that move.
Json stiffness_json(const DeformableObject& mesh) {
  const auto is_fixed = [](std::uint8_t level) { return level == 0; };
  std::vector<std::uint8_t> levels = mesh.stiffness;
  std::erase_if(levels, is_fixed);
  if (levels.empty()) return nullptr;
  const auto [least, largest] = std::ranges::minmax_element(levels);
  return {{"least", stiffness_of_level(*least)}, {"largest", stiffness_of_level(*largest)}};
}

Json mesh_header_json(const DeformableObject& mesh, std::uint32_t tick_rate) {
  const bool is_main = mesh.profile == DeformableProfile::main;
  Json out{{"name", mesh.name},
           {"profile", is_main ? "main" : "thesis"},
           {"vertices", mesh.rest.size()},
           {"triangles", mesh.triangles.size()},
           {"rings", mesh.rings},
           {"modes", mesh.basis.steps.size()}};
  if (mesh.body) out["elastic_method"] = kElasticMethods[static_cast<std::size_t>(mesh.body->method) - 1];
  if (mesh.cluster_basis.count > 0) out["clusters"] = mesh.cluster_basis.count;
  if (!mesh.stiffness.empty()) out["stiffness_N_per_m"] = stiffness_json(mesh);
  if (is_main) {
    out["layered"] = mesh.layered;
    out["frame_period_s"] = mesh.frame_period / 256.0 / tick_rate;
  } else {
    out["quant_bits"] = mesh.quant_bits;
    out["models_kept"] = mesh.models_kept;
  }
  return out;
}

/// What a scene may have and this one has, besides objects and loads.
void add_parts(const Scene& scene, Json& out) {
  if (scene.motion) {
    const double unit = step_of(scene.grid.velocity);
    const auto& g = scene.motion->gravity;
    if (g != std::array<std::int32_t, 3>{}) out["gravity_m_s2"] = Json::array({unit * g[0], unit * g[1], unit * g[2]});
    if (scene.motion->slide_deceleration != 0) out["slide_deceleration_m_s2"] = unit * scene.motion->slide_deceleration;
  }
  if (scene.driven)
    out["driven_objects"] =
        std::ranges::count_if(scene.driven->bodies, [](const DrivenConstants::Body& body) { return body.coupling != 0; });
  if (scene.interest) {
    const double unit = step_of(scene.grid.position);
    out["interest"] = {{"full_m", unit * scene.interest->full}, {"reach_m", unit * scene.interest->reach}};
  }
}

/// Fractions of what would be sent without reduction need the trace.
Json without_fractions(Json traffic) {
  for (const char* name : {"payload", "with_udp_ipv4"})
    for (const char* fraction : {"reduction_from_24_byte_states", "reduction_from_48_byte_states"}) traffic[name].erase(fraction);
  traffic.erase("reduction_of_updates");
  return traffic;
}

Json forces_json(RecordedForces known) {
  Json out = Json::array();
  if (known != RecordedForces::server) out.push_back("rendered");
  if (known != RecordedForces::rendered) out.push_back("server");
  return out;
}

/// "2026-01-31 09:30:00 UTC"   in  time  [ns] since 1970-01-01 UTC
std::string text_of_wall_time(std::int64_t time) {
  return fmt::format("{:%Y-%m-%d %H:%M:%S} UTC", fmt::gmtime(static_cast<std::time_t>(time / 1'000'000'000)));
}

Json capture_json(const TraceCapture& capture) {
  return {{"started_ns", capture.started},    {"started", text_of_wall_time(capture.started)},
          {"device", capture.device},         {"backend", capture.backend},
          {"scheduling", capture.scheduling}, {"subject", capture.subject},
          {"remarks", capture.remarks}};
}

}  // namespace

Value packet_info_value(const PlayedPacket& played, const Scene& scene) {
  Json out{{"tick", played.tick},   {"byte", played.offset}, {"number", played.number},
           {"bytes", played.bytes}, {"key", played.key},     {"substream", played.substream}};
  if (!scene.deformables.empty() || scene.loads)
    out["content"] = played.substream == 0                         ? "rigid objects"
                     : played.substream > scene.deformables.size() ? "loads"
                                                                   : scene.deformables[played.substream - 1].name;
  if (played.loads > 0) {
    out["loads"] = played.loads;
    return out;
  }
  if (played.substream > 0) {
    out["layer"] = kLayers[static_cast<std::size_t>(played.layer)];
    out["vertices"] = played.vertices;
    return out;
  }
  out["reason"] = kReasons[static_cast<std::size_t>(strongest_reason(played))];
  out["updates"] = Json::array();
  for (const RigidUpdate& u : played.updates) out["updates"].push_back({{"object", u.object}, {"level", u.level}});
  return out;
}

Value stream_info_value(const Player& player, const StreamTotals& totals, std::uint64_t file_bytes, const StreamEnd& end) {
  const Scene& h = player.scene();
  Report report{.command = "info", .tick_rate = h.tick_rate, .stream = StreamSize{player.header_bytes(), file_bytes}};
  report.ticks.add(0);
  if (totals.last_tick > 0) report.ticks.add(totals.last_tick);
  if (totals.traffic.all_packets() > 0 || h.deformables.empty()) report.traffic = totals.traffic;
  for (std::size_t i = 0; i < totals.meshes.size(); ++i)
    report.meshes.push_back(
        {.name = h.deformables[i].name, .vertices = h.deformables[i].rest.size(), .traffic = totals.meshes[i]});

  Json out{{"schema", kSchema},
           {"kind", "stream"},
           {"tick_rate", h.tick_rate},
           {"last_tick", totals.last_tick},
           {"seconds", report.seconds()},
           {"complete", end.complete},
           {"position_grid_m", step_of(h.grid.position)},
           {"rotation_grid_rad", 4 * step_of(h.grid.rotation)},
           {"max_extrapolation_ticks", h.max_extrapolation},
           {"baseline_span", h.baseline_span},
           {"stream", stream_value(report)}};
  add_parts(h, out);
  if (end.error) out["broken"] = {{"byte", end.error->bit_offset / 8}, {"rule", end.error->rule}};
  if (report.traffic) {
    out["profile"] = h.is_smoothed ? "main" : "thesis";
    out["traffic"] = without_fractions(Json(rigid_traffic_value(report)));
    out["grid_levels"] = totals.levels;
    if (totals.rigid.packets > 0) {
      out["traffic"]["min_bytes"] = totals.rigid.smallest;
      out["traffic"]["max_bytes"] = totals.rigid.largest;
    }
  }
  if (h.loads) out["loads"] = load_traffic_value(totals.loads, report.seconds());
  if (h.bounds && h.bounds->rigid) out["bounds"] = bounds_value(*h.bounds->rigid);
  out["objects"] = Json::array();
  for (const RigidObject& o : h.objects) {
    const Pose pose = to_pose(o.initial, h.grid.position);
    const Quat& q = pose.rotation;
    out["objects"].push_back({{"name", o.name},
                              {"dof", dof_json(o.dof)},
                              {"position_m", vector_json(pose.position)},
                              {"rotation", Json::array({q.w, q.x, q.y, q.z})}});
  }
  out["deformables"] = Json::array();
  for (std::size_t i = 0; i < h.deformables.size(); ++i) {
    out["deformables"].push_back(mesh_header_json(h.deformables[i], h.tick_rate));
    if (h.bounds)
      out["deformables"].back()["bounds"] =
          mesh_bounds_value(h.bounds->deformables[i].thresholds, h.deformables[i].rings, h.bounds->deformables[i].kept);
    out["deformables"].back()["traffic"] = mesh_traffic_value(report.meshes[i], report.seconds());
  }
  return out;
}

Value trace_info_value(const TraceInfo& trace, const TraceTotals& totals) {
  const auto length = static_cast<double>(totals.last - totals.first + (totals.frames > 0 ? 1 : 0));
  Json out{{"schema", kSchema},
           {"kind", "trace"},
           {"source", trace.source},
           {"tick_rate", trace.tick_rate},
           {"ticks", totals.frames},
           {"first_tick", totals.first},
           {"last_tick", totals.last},
           {"seconds", length / trace.tick_rate},
           {"scene_bytes", trace.scene.size()},
           {"complete", totals.complete}};
  out["objects"] = Json::array();
  for (const TraceObject& o : trace.objects) out["objects"].push_back({{"name", o.name}, {"dof", dof_json(o.dof)}});
  out["deformables"] = Json::array();
  for (std::size_t i = 0; i < trace.meshes.size(); ++i) {
    const TraceDeformable& mesh = trace.meshes[i];
    out["deformables"].push_back({{"name", mesh.name},
                                  {"vertices", mesh.rest.vertices.size()},
                                  {"triangles", mesh.rest.triangles.size()},
                                  {"fixed_vertices", mesh.fixed.size()},
                                  {"frame_period_s", mesh.period / trace.tick_rate},
                                  {"shapes", totals.shapes[i]}});
  }
  out["users"] = Json::array();
  for (const TraceUser& user : trace.users) out["users"].push_back({{"name", user.name}, {"forces", forces_json(user.forces)}});
  if (trace.capture) out["capture"] = capture_json(*trace.capture);
  return out;
}

#ifdef TACTUS_HAS_SIM
Value scene_info_value(const sim::Scene& scene) {
  Json out{{"schema", kSchema}, {"kind", "scene"}, {"name", scene.name}, {"seconds", scene.duration}};
  if (scene.floor) out["floor_m"] = *scene.floor;
  if (scene.touch) out["touch_stiffness_N_per_m"] = scene.touch->stiffness;
  out["objects"] = Json::array();
  for (const sim::SceneObject& o : scene.objects)
    out["objects"].push_back({{"name", o.name},
                              {"dof", dof_json(o.dof)},
                              {"mass_kg", o.mass},
                              {"friction", o.friction},
                              {"triangles", o.surface.triangles.size()},
                              {"size_m", vector_json(o.size)}});
  out["one_dimensional_objects"] = Json::array();
  for (const sim::SceneMsd& m : scene.msds)
    out["one_dimensional_objects"].push_back({{"name", m.name},
                                              {"dof", dof_json(m.dof())},
                                              {"stiffness_N_per_m", m.object.stiffness},
                                              {"damping_Ns_per_m", m.object.damping},
                                              {"mass_kg", m.object.mass},
                                              {"step_s", 1e-3 * m.rate}});
  out["deformables"] = Json::array();
  for (const sim::SceneDeformable& d : scene.deformables)
    out["deformables"].push_back({{"name", d.name},
                                  {"vertices", d.mesh.vertices.size()},
                                  {"tetrahedra", d.mesh.tets.size()},
                                  {"fixed_vertices", d.fixed.size()},
                                  {"step_s", 1e-3 * d.rate},
                                  {"coupling_N_per_m", d.stiffness}});
  out["users"] = Json::array();
  for (const sim::SceneUser& u : scene.users) out["users"].push_back({{"name", u.name}, {"path_phases", u.path.size()}});
  return out;
}
#endif

}  // namespace tactus::cli
