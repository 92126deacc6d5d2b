// SPDX-License-Identifier: Apache-2.0
#include "cli/report/mesh_report.h"

#include "cli/report/figures.h"

namespace tactus::cli {
namespace {

double packets_of(const DeformableRates& t) { return static_cast<double>(t.sizes.size()); }

void layer_rows(Table& table, const DeformableRates& t, double seconds) {
  for (std::size_t i = 0; i < t.layers.size(); ++i) {
    const auto packets = static_cast<double>(t.layers[i].packets), bytes = static_cast<double>(t.layers[i].bytes);
    table.row({fmt::format("  {} packets per second", kLayers[i]), fmt::format("{:.2f}", per(packets, seconds))});
    table.row({fmt::format("  {} kbit/s", kLayers[i]), fmt::format("{:.2f}", 8e-3 * per(bytes, seconds)),
               fmt::format("{:.2f}", 8e-3 * per(bytes + packets * static_cast<double>(kUdpHeader), seconds))});
  }
}

void traffic_rows(Table& table, const MeshReport& mesh, double seconds) {
  const DeformableRates& t = *mesh.traffic;
  table.heading({mesh.name, "payload", "with UDP/IPv4"});
  const auto both = [&](const char* name, int digits, auto value) {
    table.row({name, fmt::format("{:.{}f}", value(bytes_of(t, 0)), digits),
               fmt::format("{:.{}f}", value(bytes_of(t, kUdpHeader)), digits)});
  };
  both("  kbit/s", 2, [&](double bytes) { return 8e-3 * per(bytes, seconds); });
  both("  bytes per packet, mean", 1, [&](double bytes) { return per(bytes, packets_of(t)); });
  if (t.frames > 0) both("  compression vs float32, times", 1, [&](double bytes) { return per(raw_bytes(mesh), bytes); });
  table.row({"  bytes per packet, p99", fmt::to_string(t.quantile(0.99))});
  table.row({"  bytes per packet, max", fmt::to_string(t.quantile(1))});
  if (t.frames > 0) table.row({"  frames per second", fmt::format("{:.2f}", per(static_cast<double>(t.frames), seconds))});
  table.row({"  packets per second", fmt::format("{:.2f}", per(packets_of(t), seconds))});
  if (has_layers(t)) layer_rows(table, t, seconds);
  table.row({"  vertices coded per packet", fmt::format("{:.1f}", per(static_cast<double>(t.updates), packets_of(t)))});
}

void error_rows(Table& table, const MeshReport& mesh, const std::string& where) {
  const DeformableErrors& f = *mesh.fidelity;
  const DeformableThresholds& b = f.bounds();
  table.heading({"error of " + mesh.name + where, "bound", "MSE [mm2]", "max", "violations", "vertices"});
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

}  // namespace

void mesh_rows(Table& table, const MeshReport& mesh, double seconds, const std::string& where) {
  if (mesh.traffic) traffic_rows(table, mesh, seconds);
  if (mesh.fidelity && mesh.fidelity->frames() > 0) error_rows(table, mesh, where);
}

}  // namespace tactus::cli
