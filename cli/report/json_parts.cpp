// SPDX-License-Identifier: Apache-2.0
#include "cli/report/json_parts.h"

#include <array>
#include <numeric>

#include "cli/report/figures.h"
#include "cli/report/json.h"

namespace tactus::cli {
namespace {

double rate(std::uint64_t number, double seconds) { return per(static_cast<double>(number), seconds); }

/// What is common to all kinds of packets.
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

constexpr std::array<std::pair<const char*, std::uint64_t>, 2> kSizes{{{"payload", 0}, {"with_udp_ipv4", kUdpHeader}}};

const char* name_of(HapticRule rule) {
  constexpr std::array kNames{"off", "isotropic", "cone", "fixed", "perceptual"};
  return kNames[static_cast<std::size_t>(rule)];
}

}  // namespace

Value time_value(const StepTimes& t, double seconds) {
  Json out{{"count", t.count()}};
  const auto add = [&](const std::string& prefix, TimeOf which) {
    out[prefix + "p50_s"] = t.quantile(which, 0.5);
    out[prefix + "p99_s"] = t.quantile(which, 0.99);
    out[prefix + "max_s"] = t.quantile(which, 1);
    out[prefix + "total_s"] = t.total(which);
    if (seconds > 0) out[prefix + "real_time_factor"] = per(seconds, t.total(which));
  };
  add("", TimeOf::wall);
  add("cpu_", TimeOf::cpu);
  return out;
}

Value rigid_traffic_value(const Report& r) {
  const RateMetrics& t = *r.traffic;
  Json out = traffic_json(t.all_packets(), t.keys, t.updates, t.bytes, r.seconds());
  // Without reduction: one packet per recorded tick with every moving object's state, raw.
  for (const auto& [name, header] : kSizes)
    for (const auto& [key, state] :
         {std::pair("reduction_from_24_byte_states", 24U), std::pair("reduction_from_48_byte_states", 48U)})
      out[name][key] = 1 - per(static_cast<double>(t.bytes + t.all_packets() * header),
                               static_cast<double>(r.ticks.count() * (r.moving * state + header)));
  out["reduction_of_updates"] = 1 - per(static_cast<double>(t.updates), static_cast<double>(r.ticks.count() * r.moving));
  for (std::size_t i = kReasons.size(); i-- > 0;)
    out["reasons"][kReasons[i]] = {{"packets", t.packets[i]}, {"packets_per_s", rate(t.packets[i], r.seconds())}};
  return out;
}

Value load_traffic_value(const LoadRates& t, double seconds) { return traffic_json(t.packets, 0, t.updates, t.bytes, seconds); }

Value mesh_traffic_value(const MeshReport& mesh, double seconds) {
  const DeformableRates& t = *mesh.traffic;
  Json out = traffic_json(t.sizes.size(), t.keys, t.updates, t.bytes, seconds);
  out["p99_bytes"] = t.quantile(0.99);
  out["max_bytes"] = t.quantile(1);
  if (t.frames > 0) {
    out["frames"] = t.frames;
    out["frames_per_s"] = rate(t.frames, seconds);
    for (const auto& [name, header] : kSizes)  // every frame as three floats per vertex
      out[name]["ratio_to_float32"] =
          per(12.0 * static_cast<double>(mesh.vertices * t.frames), static_cast<double>(t.bytes + t.sizes.size() * header));
  }
  if (t.layers[0].packets + t.layers[1].packets == 0) return out;
  for (std::size_t i = 0; i < t.layers.size(); ++i) {
    const auto& [packets, bytes] = t.layers[i];
    Json& layer = out["layers"][kLayers[i]] = {{"packets", packets}, {"packets_per_s", rate(packets, seconds)}, {"bytes", bytes}};
    for (const auto& [name, header] : kSizes) layer[name]["bit_per_s"] = 8 * rate(bytes + packets * header, seconds);
  }
  return out;
}

Value stream_value(const Report& r) {
  const auto [bytes, packets] = r.bytes_and_packets();
  const std::uint64_t own = r.stream->header_bytes;
  Json out{{"header_bytes", own}, {"payload_bytes", bytes}, {"packets", packets}};
  if (r.stream->file_bytes) out["file_bytes"] = *r.stream->file_bytes;
  for (const auto& [name, header] : kSizes)
    out[name]["bit_per_s_with_header"] = 8 * rate(bytes + own + packets * header, r.seconds());
  return out;
}

Value bounds_value(const RigidTriggers& b) {
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

Value mesh_bounds_value(const DeformableThresholds& b, std::uint8_t rings, bool promised) {
  Json out{{"position_m", b.visual},
           {"haptic_rule", b.weber_fraction ? "isotropic" : "off"},
           {"rings", rings},
           {"promised", promised}};
  if (b.weber_fraction) {
    out["haptic_fraction"] = *b.weber_fraction;
    out["depth_floor_m"] = b.depth_floor;
  }
  return out;
}

Value widening_value(const Widening& widened) {
  return Json{{"widest", widened.widest}, {"for_s", 1e-6 * static_cast<double>(widened.time)}};
}

std::string error_json(const Failure& failure) {
  Json error{{"text", failure.text}};
  for (const auto& [name, value] :
       {std::pair("remedy", &Failure::remedy), std::pair("class", &Failure::error_class), std::pair("rule", &Failure::rule),
        std::pair("file", &Failure::file), std::pair("place", &Failure::place)})
    if (!(failure.*value).empty()) error[name] = failure.*value;
  return text_of_json({{"schema", "tactus.error/1"}, {"error", std::move(error)}});
}

}  // namespace tactus::cli
