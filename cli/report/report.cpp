// SPDX-License-Identifier: Apache-2.0
#include "cli/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <tactus/base/shown.h>
#include "cli/report/figures.h"
#include "cli/report/json.h"
#include "cli/report/json_parts.h"
#include "cli/report/table.h"
#include "cli/report/traffic_layers.h"

namespace tactus::cli {
namespace {

bool has_errors(const ErrorMetrics& f) { return f.position().ticks() > 0 || f.rendered().ticks() > 0; }

/// Errors of one quantity: of ticks, or of vertices in all frames.
Json series_json(std::uint64_t samples, std::uint64_t over, double mse, double max) {
  return {{"samples", samples},    {"over", over}, {"share_over", per(static_cast<double>(over), static_cast<double>(samples))},
          {"rms", std::sqrt(mse)}, {"mse", mse},   {"max", max}};
}

Json series_json(const Report& r, const ErrorSeries& s) {
  Json out = series_json(s.ticks(), s.ticks_over(), s.rms() * s.rms(), s.max());
  out["longest_run_s"] = static_cast<double>(s.longest_run()) / r.tick_rate;
  return out;
}

Json series_json(const VertexErrors& e) { return series_json(e.vertices, e.violations, e.mse(), e.max); }

Json errors_json(const Report& r, const ErrorMetrics& f) {
  Json out;
  if (f.position().ticks() > 0) {
    out["position_m"] = series_json(r, f.position());
    out["rotation_rad"] = series_json(r, f.rotation());
  }
  if (f.force().ticks() > 0) {
    if (f.bounds().haptic != HapticRule::off) {
      out["contact_force_N"] = series_json(r, f.force());
      out["contact_force_N"]["worst_ratio"] = f.worst_haptic_ratio();
    }
    out["contact_force_perception_N"] = series_json(r, f.perceived());
  }
  if (f.rendered().ticks() > 0) out["rendered_force_perception_N"] = series_json(r, f.rendered());
  return out;
}

Json mesh_json(const MeshReport& mesh, double seconds) {
  Json out{{"name", mesh.name}, {"vertices", mesh.vertices}};
  if (mesh.triangles > 0) out["triangles"] = mesh.triangles;
  if (mesh.frames > 0) {
    out["frames"] = mesh.frames;
    out["frame_period_s"] = mesh.frame_period;
  }
  if (mesh.traffic) out["traffic"] = mesh_traffic_value(mesh, seconds);
  if (mesh.fidelity) {
    const DeformableErrors& f = *mesh.fidelity;
    out["bounds"] = mesh_bounds_value(f.bounds(), f.rings(), mesh.promised);
    out["error"] = {{"frames", f.frames()}, {"worst_ratio", f.worst_ratio()}, {"position_m", series_json(f.all())}};
    out["error"]["haptic_area_m"] = series_json(f.area());
    out["error"]["haptic_area_m"]["mean_bound"] = f.mean_haptic();
  }
  if (!mesh.encode.empty()) out["time"]["encode"] = time_value(mesh.encode, seconds);
  if (!mesh.decode.empty()) out["time"]["decode"] = time_value(mesh.decode, seconds);
  return out;
}

Json solver_json(const DeformableReport& d) {
  constexpr std::uint64_t kFew = 10;
  Json out{{"name", d.name}, {"vertices", d.vertices}, {"step_s", d.step}, {"method", d.method}, {"reason", d.reason}};
  if (d.h_omega > 0) out["h_omega"] = d.h_omega;
  if (d.samples > 0) {
    out["step_error"] = {{"samples", d.samples}, {"p50", d.error_p50}, {"max", d.error_max}};
    if (d.samples < kFew) out["step_error"]["note"] = "too few to tell";
    out["energy_gained"] = d.energy_gained;
  }
  return out;
}

Json direction_json(const DirectionReport& direction, double seconds) {
  const TrafficLayers l = sent_layers(direction.traffic, seconds);
  return {{"packets_per_s", l.packets},      {"datagrams_per_s", l.datagrams},  {"payload_bit_per_s", l.payload},
          {"session_bit_per_s", l.session},  {"udp_ipv4_bit_per_s", l.headers}, {"all_bit_per_s", l.all()},
          {"datagrams", direction.sent},     {"lost", direction.lost},          {"duplicated", direction.duplicated},
          {"overtaken", direction.overtaken}};
}

Json network_json(const Report& r, const NetworkReport& user) {
  const auto seconds_of = [](auto microseconds) { return 1e-6 * static_cast<double>(microseconds); };
  Json out{{"user", user.user},
           {"up", direction_json(user.up, r.seconds())},
           {"down", direction_json(user.down, r.seconds())},
           {"shown_behind_s", per(user.delay_sum, static_cast<double>(user.shown))},
           {"ticks_not_shown", user.not_shown},
           {"ticks_without_full_force", user.without_force},
           {"packets_refused", user.status.traffic.packets_refused},
           {"wrong_states", user.down.traffic.wrong_states},
           {"bounds_widened", widening_value(user.widened)}};
  if (const auto& trip = user.status.round_trip)
    out["round_trip_s"] = {
        {"smoothed", seconds_of(trip->smoothed)}, {"variation", seconds_of(trip->variation)}, {"least", seconds_of(trip->least)}};
  if (user.status.clock_offset) out["clock_offset_s"] = seconds_of(*user.status.clock_offset);
  out["bounds"] = bounds_value(user.errors.bounds());
  if (has_errors(user.errors)) out["error"] = errors_json(r, user.errors);
  for (const MeshReport& mesh : user.meshes) out["deformables"].push_back(mesh_json(mesh, r.seconds()));
  return out;
}

/// What only some commands know.
void add_particulars(Json& out, const Report& r) {
  if (r.seed) out["seed"] = *r.seed;
  if (r.segments) out["segments"] = *r.segments;
  constexpr std::array kWays{"direct", "eased", "interpolated"};
  if (r.client) out["client"] = kWays[static_cast<std::size_t>(*r.client)];
  for (const DeformableReport& d : r.deformables) out["solvers"].push_back(solver_json(d));
  for (const TouchReport& t : r.touches) {
    out["touches"].push_back({{"user", t.user},
                              {"share", t.share},
                              {"contacts", t.contacts},
                              {"contacts_most_in_a_second", t.most_in_a_second},
                              {"largest_force_N", t.largest_force},
                              {"lowest_energy_J", t.lowest_energy}});
  }
  for (const std::string& warning : r.warnings) out["warnings"].push_back(warning);
}

void add_verdict(Json& out, const Report& r) {
  if (!r.bounds_from.empty()) {
    const std::string broken = broken_bounds(r);
    out["bounds_from"] = r.bounds_from;
    out["bounds_held"] = broken.empty();
    out["verdict"] = broken.empty() ? "All bounds hold." : "Bounds are broken: " + broken + ".";
  }
}

Value value_of(const Report& r) {
  Json out{{"schema", "tactus.report/3"}, {"command", r.command}};
  for (const auto& [role, path] : r.files) out["files"][role] = path;
  if (r.tick_rate > 0) {
    out["tick_rate"] = r.tick_rate;
    out["ticks"] = r.ticks.count();
    out["ticks_left_out"] = r.ticks.left_out();
    out["seconds"] = r.seconds();
    out["object_count"] = r.objects;
    out["user_count"] = r.users;
  }
  add_particulars(out, r);
  if (r.stream) out["stream"] = stream_value(r);
  if (r.traffic) out["traffic"] = rigid_traffic_value(r);
  if (r.loads) out["loads"] = load_traffic_value(*r.loads, r.seconds());
  if (r.fidelity && has_errors(*r.fidelity)) {
    out["bounds"] = bounds_value(r.fidelity->bounds());
    out["error"] = errors_json(r, *r.fidelity);
  }
  add_verdict(out, r);
  for (const NetworkReport& user : r.networks) out["sessions"].push_back(network_json(r, user));
  for (const MeshReport& mesh : r.meshes) out["deformables"].push_back(mesh_json(mesh, r.seconds()));
  for (const Timing& t : r.timings)
    if (!t.times.empty()) out["time"][t.step] = time_value(t.times, r.seconds());
  return out;
}

}  // namespace

std::string broken_bounds(const Report& r) {
  std::string text;
  const auto look = [&](const std::string& name, std::uint64_t over, std::uint64_t all, const char* what) {
    if (over > 0) text += fmt::format("{}{} {} of {}", text.empty() ? "" : "; ", name, over, counted(all, what));
  };
  if (r.fidelity) {
    const ErrorMetrics& f = *r.fidelity;
    look("position in", f.position().ticks_over(), f.position().ticks(), "tick");
    look("rotation in", f.rotation().ticks_over(), f.rotation().ticks(), "tick");
    if (f.bounds().haptic != HapticRule::off) look("contact force in", f.force().ticks_over(), f.force().ticks(), "tick");
  }
  for (const MeshReport& mesh : r.meshes)
    if (mesh.fidelity && mesh.promised)
      look(shown(mesh.name) + " at", mesh.fidelity->all().violations, mesh.fidelity->all().vertices, "vertex");
  return text;
}

Outcome verdict(const Report& r, const std::string& file) {
  const std::string broken = broken_bounds(r);
  if (broken.empty()) return {};
  Failure failure{file + ": bounds are broken: " + broken, ""};
  failure.cause = Failure::Cause::bound;
  failure.file = file;
  return tl::unexpected(std::move(failure));
}

std::pair<std::uint64_t, std::uint64_t> Report::bytes_and_packets() const {
  std::pair<std::uint64_t, std::uint64_t> all{};
  if (traffic) all = {traffic->bytes, traffic->all_packets()};
  if (loads) {
    all.first += loads->bytes;
    all.second += loads->packets;
  }
  for (const MeshReport& mesh : meshes) {
    if (!mesh.traffic) continue;
    all.first += mesh.traffic->bytes;
    all.second += mesh.traffic->sizes.size();
  }
  return all;
}

void Report::describe(const TraceInfo& info) {
  tick_rate = info.tick_rate;
  objects = info.objects.size();
  users = info.users.size();
  moving = static_cast<std::uint64_t>(
      std::count_if(info.objects.begin(), info.objects.end(), [](const TraceObject& o) { return o.dof != Dof::none; }));
}

void add_meshes(const TraceInfo& info, const MeshArguments& meshes, const TriggerArguments& triggers, Report& report) {
  for (const TraceDeformable& mesh : info.meshes) {
    report.meshes.push_back({.name = mesh.name, .vertices = mesh.rest.vertices.size()});
    report.meshes.back().traffic.emplace();
    report.meshes.back().fidelity.emplace(mesh.rest, meshes.thresholds(triggers), meshes.rings(), GridExponents{}.position);
  }
}

void print(const Report& report, const CommonOptions& options, Destination destination) {
  print(value_of(report), "report", options, destination == Destination::standard_output ? stdout : stderr);
}

}  // namespace tactus::cli
