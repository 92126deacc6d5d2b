// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/report/figures.h"
#include "cli/report/json_parts.h"
#include "cli/report/report_json.h"

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;

double rate(std::uint64_t number, double seconds) { return per(static_cast<double>(number), seconds); }

/// What rigid objects and meshes have in common.
Json traffic_json(std::uint64_t packets, std::uint64_t keys, std::uint64_t updates, std::uint64_t bytes, double seconds) {
  const auto at = [&](std::uint64_t header) -> Json {
    const auto all = static_cast<double>(bytes + packets * header);
    return {{"bit_per_s", 8 * per(all, seconds)},
            {"bytes_per_packet", per(all, static_cast<double>(packets))},
            {"bytes_per_update", per(all, static_cast<double>(updates))}};
  };
  return {{"packets", packets}, {"packets_per_s", rate(packets, seconds)}, {"key_packets", keys},
          {"updates", updates}, {"updates_per_s", rate(updates, seconds)}, {"bytes", bytes},
          {"payload", at(0)},   {"with_udp_ipv4", at(kUdpHeader)}};
}

}  // namespace

Json rigid_traffic_json(const Report& r) {
  const RateMetrics& t = *r.traffic;
  Json out = traffic_json(t.all_packets(), t.keys, t.updates, t.bytes, r.seconds());
  for (const auto& [name, header] : {std::pair("payload", std::uint64_t{0}), std::pair("with_udp_ipv4", kUdpHeader)}) {
    const RigidRates rates = rigid_rates(r, header);
    out[name]["reduction_from_24_byte_states"] = rates.saved_24;
    out[name]["reduction_from_48_byte_states"] = rates.saved_48;
  }
  out["reduction_of_updates"] = 1 - per(static_cast<double>(t.updates), static_cast<double>(r.ticks.count() * r.moving));
  for (std::size_t i = kReasons.size(); i-- > 0;)
    out["reasons"][kReasons[i]] = {{"packets", t.packets[i]}, {"packets_per_s", rate(t.packets[i], r.seconds())}};
  return out;
}

Json load_traffic_json(const LoadRates& t, double seconds) { return traffic_json(t.packets, 0, t.updates, t.bytes, seconds); }

Json mesh_traffic_json(const MeshReport& mesh, double seconds) {
  const DeformableRates& t = *mesh.traffic;
  Json out = traffic_json(t.sizes.size(), t.keys, t.updates, t.bytes, seconds);
  out["p99_bytes"] = t.quantile(0.99);
  out["max_bytes"] = t.quantile(1);
  if (t.frames > 0) {
    out["frames"] = t.frames;
    out["frames_per_s"] = rate(t.frames, seconds);
    out["payload"]["ratio_to_float32"] = per(raw_bytes(mesh), bytes_of(t, 0));
    out["with_udp_ipv4"]["ratio_to_float32"] = per(raw_bytes(mesh), bytes_of(t, kUdpHeader));
  }
  if (!has_layers(t)) return out;
  for (std::size_t i = 0; i < t.layers.size(); ++i) {
    const auto& [packets, bytes] = t.layers[i];
    out["layers"][kLayers[i]] = {{"packets", packets},
                                 {"packets_per_s", rate(packets, seconds)},
                                 {"bytes", bytes},
                                 {"payload", {{"bit_per_s", 8 * rate(bytes, seconds)}}},
                                 {"with_udp_ipv4", {{"bit_per_s", 8 * rate(bytes + packets * kUdpHeader, seconds)}}}};
  }
  return out;
}

Json stream_json(const Report& r) {
  const auto [bytes, packets] = r.bytes_and_packets();
  const std::uint64_t header = r.stream->header_bytes;
  Json out{{"header_bytes", header}, {"payload_bytes", bytes}, {"packets", packets}};
  if (r.stream->file_bytes) out["file_bytes"] = *r.stream->file_bytes;
  out["payload"] = {{"bit_per_s_with_header", 8 * rate(bytes + header, r.seconds())}};
  out["with_udp_ipv4"] = {{"bit_per_s_with_header", 8 * rate(bytes + header + packets * kUdpHeader, r.seconds())}};
  return out;
}

namespace {

const char* name_of(HapticRule rule) {
  switch (rule) {
    case HapticRule::off:
      return "off";
    case HapticRule::isotropic:
      return "isotropic";
    case HapticRule::cone:
      return "cone";
    case HapticRule::fixed:
      return "fixed";
    case HapticRule::perceptual:
      return "perceptual";
  }
  return "";
}

}  // namespace

Json bounds_json(const RigidTriggers& b) {
  Json out{{"position_m", b.visual_position}, {"rotation_rad", b.visual_rotation}, {"haptic_rule", name_of(b.haptic)}};
  const bool is_constant = b.haptic == HapticRule::isotropic || b.haptic == HapticRule::cone;
  if (is_constant) out["haptic_fraction"] = b.weber_fraction;
  if (b.haptic == HapticRule::perceptual) out["perceptual_share"] = b.perceptual_share;
  if (is_constant || b.haptic == HapticRule::perceptual) out["force_floor_N"] = b.force_floor;
  if (b.haptic == HapticRule::cone) out["haptic_angle_rad"] = b.cone_angle;
  if (b.haptic == HapticRule::fixed) {
    out["haptic_position_m"] = b.fixed_position;
    out["haptic_rotation_rad"] = b.fixed_rotation;
  }
  return out;
}

namespace {

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

Json mesh_bounds_json(const DeformableErrors& f, bool promised) {
  Json out{{"position_m", f.bounds().visual},
           {"haptic_rule", f.bounds().weber_fraction ? "isotropic" : "off"},
           {"rings", f.rings()},
           {"promised", promised}};
  if (f.bounds().weber_fraction) {
    out["haptic_fraction"] = *f.bounds().weber_fraction;
    out["depth_floor_m"] = f.bounds().depth_floor;
  }
  return out;
}

Json errors_json(const Report& r, const ErrorMetrics& f) {
  Json out;
  if (&f == (r.fidelity ? &*r.fidelity : nullptr) && !missing_force_bound(r).empty())
    out["users_without_force_bound"] = f.unbound_users();
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

Json mesh_errors_json(const DeformableErrors& f) {
  Json out{{"frames", f.frames()}, {"worst_ratio", f.worst_ratio()}, {"position_m", series_json(f.all())}};
  out["haptic_area_m"] = series_json(f.area());
  out["haptic_area_m"]["mean_bound"] = f.mean_haptic();
  return out;
}

Json mesh_json(const MeshReport& mesh, double seconds) {
  Json out{{"name", mesh.name}, {"vertices", mesh.vertices}};
  if (mesh.triangles > 0) out["triangles"] = mesh.triangles;
  if (mesh.frames > 0) {
    out["frames"] = mesh.frames;
    out["frame_period_s"] = mesh.frame_period;
  }
  if (mesh.traffic) out["traffic"] = mesh_traffic_json(mesh, seconds);
  if (mesh.fidelity) {
    out["bounds"] = mesh_bounds_json(*mesh.fidelity, mesh.promised);
    out["error"] = mesh_errors_json(*mesh.fidelity);
  }
  if (!mesh.encode.empty()) out["time"]["encode"] = time_json(mesh.encode, seconds);
  if (!mesh.decode.empty()) out["time"]["decode"] = time_json(mesh.decode, seconds);
  return out;
}

Json deformable_json(const DeformableReport& d) {
  Json out{{"name", d.name}, {"vertices", d.vertices}, {"step_s", d.step}, {"method", d.method}, {"reason", d.reason}};
  if (d.h_omega > 0) out["h_omega"] = d.h_omega;
  if (d.samples > 0) {
    out["step_error"] = {{"samples", d.samples}, {"p50", d.error_p50}, {"max", d.error_max}};
    out["energy_gained"] = d.energy_gained;
  }
  return out;
}

/// What only some commands know.
void add_particulars(Json& out, const Report& r) {
  if (r.seed) out["seed"] = *r.seed;
  if (r.segments) out["segments"] = *r.segments;
  constexpr std::array kWays{"direct", "eased", "interpolated"};
  if (r.client) out["client"] = kWays[static_cast<std::size_t>(*r.client)];
  for (const DeformableReport& d : r.deformables) out["solvers"].push_back(deformable_json(d));
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

}  // namespace

std::string to_json(const Report& r) {
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
  if (r.stream) out["stream"] = stream_json(r);
  if (r.traffic) out["traffic"] = rigid_traffic_json(r);
  if (r.loads) out["loads"] = load_traffic_json(*r.loads, r.seconds());
  if (r.fidelity && has_errors(*r.fidelity)) {
    out["bounds"] = bounds_json(r.fidelity->bounds());
    out["error"] = errors_json(r, *r.fidelity);
  }
  if (!r.bounds_from.empty()) {
    out["bounds_from"] = r.bounds_from;
    out["bounds_held"] = broken_bounds(r).empty();
  }
  for (const NetworkReport& user : r.networks) {
    Json session = network_json(user, r.seconds());
    session["bounds"] = bounds_json(user.errors.bounds());
    if (has_errors(user.errors)) session["error"] = errors_json(r, user.errors);
    for (const MeshReport& mesh : user.meshes) session["deformables"].push_back(mesh_json(mesh, r.seconds()));
    out["sessions"].push_back(std::move(session));
  }
  for (const MeshReport& mesh : r.meshes) out["deformables"].push_back(mesh_json(mesh, r.seconds()));
  for (const Timing& t : r.timings)
    if (!t.times.empty()) out["time"][t.key] = time_json(t.times, r.seconds());
  return text_of_json(out);
}

}  // namespace tactus::cli
