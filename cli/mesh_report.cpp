// SPDX-License-Identifier: Apache-2.0
#include "cli/mesh_report.h"

#include <nlohmann/json.hpp>

#include "cli/figures.h"

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;

double packets_of(const MeshTraffic& t) { return static_cast<double>(t.sizes.size()); }
double bytes_of(const MeshTraffic& t, std::uint64_t header) {
  return static_cast<double>(t.bytes) + packets_of(t) * static_cast<double>(header);
}
constexpr std::array<const char*, 2> kHalves{"haptic", "visual"};  // index: MeshHalf

bool has_halves(const MeshTraffic& t) { return t.halves[0].packets + t.halves[1].packets > 0; }

/// Every frame as three floats per vertex.
double raw_bytes(const MeshReport& mesh) { return 12.0 * static_cast<double>(mesh.vertices * mesh.traffic->frames); }

void half_rows(Table& table, const MeshTraffic& t, double seconds) {
  for (std::size_t i = 0; i < kHalves.size(); ++i) {
    const auto packets = static_cast<double>(t.halves[i].packets), bytes = static_cast<double>(t.halves[i].bytes);
    table.row({fmt::format("  {} packets per second", kHalves[i]), fmt::format("{:.2f}", per(packets, seconds))});
    table.row({fmt::format("  {} kbit/s", kHalves[i]), fmt::format("{:.2f}", 8e-3 * per(bytes, seconds)),
               fmt::format("{:.2f}", 8e-3 * per(bytes + packets * static_cast<double>(kUdpHeader), seconds))});
  }
}

void traffic_rows(Table& table, const MeshReport& mesh, double seconds) {
  const MeshTraffic& t = *mesh.traffic;
  table.heading({mesh.name, "payload", "with UDP/IPv4"});
  const auto both = [&](const char* name, int digits, auto value) {
    table.row({name, fmt::format("{:.{}f}", value(bytes_of(t, 0)), digits),
               fmt::format("{:.{}f}", value(bytes_of(t, kUdpHeader)), digits)});
  };
  both("  kbit/s", 2, [&](double bytes) { return 8e-3 * per(bytes, seconds); });
  both("  bytes per packet, mean", 1, [&](double bytes) { return per(bytes, packets_of(t)); });
  if (t.frames > 0) both("  smaller than float32, times", 1, [&](double bytes) { return per(raw_bytes(mesh), bytes); });
  table.row({"  bytes per packet, p99", fmt::to_string(t.quantile(0.99))});
  table.row({"  bytes per packet, max", fmt::to_string(t.quantile(1))});
  if (t.frames > 0) table.row({"  frames per second", fmt::format("{:.2f}", per(static_cast<double>(t.frames), seconds))});
  table.row({"  packets per second", fmt::format("{:.2f}", per(packets_of(t), seconds))});
  if (has_halves(t)) half_rows(table, t, seconds);
  table.row({"  vertices coded per packet", fmt::format("{:.1f}", per(static_cast<double>(t.updates), packets_of(t)))});
}

void error_rows(Table& table, const MeshReport& mesh) {
  const MeshFidelity& f = *mesh.fidelity;
  const MeshThresholds& b = f.bounds();
  table.heading({"error of " + mesh.name, "bound", "MSE [mm2]", "max", "violations", "vertices"});
  const auto row = [&](const std::string& name, const std::string& bound, const VertexErrors& e) {
    table.row({name, bound, significant(1e6 * e.mse()), significant(1e3 * e.max, 5), fmt::to_string(e.violations),
               fmt::to_string(e.vertices)});
  };
  row("  all vertices [mm]", significant(1e3 * b.visual), f.all());
  if (f.area().vertices > 0) {
    const std::string haptic =
        b.weber_fraction ? fmt::format("{}: {:.3g} on average", percent(*b.weber_fraction), 1e3 * f.mean_haptic()) : "off";
    row(fmt::format("  area of {} rings [mm]", f.rings()), haptic, f.area());
  }
  table.row({"  largest error / bound", "1", "", fmt::format("{:.5g}", f.worst_ratio())});
}

Json rates_json(double bytes, const MeshReport& mesh, double seconds) {
  Json out{{"bit_per_s", 8 * per(bytes, seconds)}, {"bytes_per_packet", per(bytes, packets_of(*mesh.traffic))}};
  if (mesh.traffic->frames > 0) out["ratio_to_float32"] = per(raw_bytes(mesh), bytes);
  return out;
}

Json traffic_json(const MeshReport& mesh, double seconds) {
  const MeshTraffic& t = *mesh.traffic;
  Json out{{"frames", t.frames},
           {"packets", t.sizes.size()},
           {"packets_per_s", per(packets_of(t), seconds)},
           {"key_packets", t.keys},
           {"vertices_coded", t.updates},
           {"bytes", t.bytes},
           {"p99_bytes", t.quantile(0.99)},
           {"max_bytes", t.quantile(1)},
           {"payload", rates_json(bytes_of(t, 0), mesh, seconds)},
           {"with_udp_ipv4", rates_json(bytes_of(t, kUdpHeader), mesh, seconds)}};
  if (!has_halves(t)) return out;
  for (std::size_t i = 0; i < kHalves.size(); ++i)
    out["halves"][kHalves[i]] = {{"packets", t.halves[i].packets}, {"bytes", t.halves[i].bytes}};
  return out;
}

Json errors_json(const VertexErrors& e) {
  return {{"vertices", e.vertices}, {"mse_m2", e.mse()}, {"max_m", e.max}, {"violations", e.violations}};
}

Json times_json(const StepTimes& t) {
  return {{"count", t.count()}, {"p50_s", t.quantile(0.5)}, {"p99_s", t.quantile(0.99)}, {"max_s", t.quantile(1)}};
}

}  // namespace

Result<MeshPackets> transmit(MeshLink& link, const TraceFrame& frame, std::size_t index, MeshReport& report) {
  const auto touch = touch_of(frame, index);
  const MeshSample& mesh = frame.meshes[index];
  TACTUS_TRY(const MeshPackets packets,
             report.encode.measure([&] { return link.encode(frame.tick, mesh.displacements, touch); }));
  for (const EncodedMeshPacket& packet : packets) {
    if (!packet.bytes.empty()) TACTUS_CHECK(report.decode.measure([&] { return link.decode(packet.bytes); }));
  }
  report.fidelity->add(mesh.displacements, link.shown(frame.tick), touch);
  return packets;
}

void mesh_rows(Table& table, const MeshReport& mesh, double seconds) {
  if (mesh.traffic) traffic_rows(table, mesh, seconds);
  if (mesh.fidelity && mesh.fidelity->frames() > 0) error_rows(table, mesh);
}

Json mesh_json(const MeshReport& mesh, double seconds) {
  Json out{{"name", mesh.name}, {"vertices", mesh.vertices}};
  if (mesh.traffic) out["traffic"] = traffic_json(mesh, seconds);
  if (mesh.fidelity) {
    const MeshFidelity& f = *mesh.fidelity;
    out["error"] = {{"frames", f.frames()},
                    {"visual_bound_m", f.bounds().visual},
                    {"haptic_fraction", f.bounds().weber_fraction ? Json(*f.bounds().weber_fraction) : Json()},
                    {"mean_haptic_bound_m", f.mean_haptic()},
                    {"rings", f.rings()},
                    {"worst_ratio", f.worst_ratio()},
                    {"all", errors_json(f.all())},
                    {"area", errors_json(f.area())}};
  }
  if (!mesh.encode.empty()) out["encode"] = times_json(mesh.encode);
  if (!mesh.decode.empty()) out["decode"] = times_json(mesh.decode);
  return out;
}

}  // namespace tactus::cli
