// SPDX-License-Identifier: Apache-2.0
#include "cli/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "cli/figures.h"
#include "cli/table.h"

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegree = std::numbers::pi / 180;
constexpr std::array<const char*, 4> kReasons{"request", "heartbeat", "visual", "haptic"};  // index: Reason

/// Rates of a stream at two sizes of what goes below a packet.
struct Rates {
  double bits_per_s, bytes_per_packet, bytes_per_update, saved_24, saved_48;
};

Rates rates(const Report& r, std::uint64_t header) {
  const Traffic& t = *r.traffic;
  const auto packets = static_cast<double>(t.all_packets());
  const double bytes = static_cast<double>(t.bytes) + packets * static_cast<double>(header);
  // Without reduction: one packet per tick with every moving object's state, raw.
  const auto raw = [&](std::uint64_t state) { return static_cast<double>(r.ticks.count() * (r.moving * state + header)); };
  return {8 * per(bytes, r.seconds()), per(bytes, packets), per(bytes, static_cast<double>(t.updates)), 1 - per(bytes, raw(24)),
          1 - per(bytes, raw(48))};
}

void traffic_rows(Table& table, const Report& r) {
  const Traffic& t = *r.traffic;
  table.heading({"packets", "number", "per second"});
  for (std::size_t i = kReasons.size(); i-- > 0;) {
    table.row({fmt::format("  {}", kReasons[i]), fmt::to_string(t.packets[i]),
               fmt::format("{:.2f}", per(static_cast<double>(t.packets[i]), r.seconds()))});
  }
  const auto all = static_cast<double>(t.all_packets());
  table.row({"  all", fmt::to_string(t.all_packets()), fmt::format("{:.2f}", per(all, r.seconds()))});
  table.row({"  object updates in them", fmt::to_string(t.updates),
             fmt::format("{:.2f}", per(static_cast<double>(t.updates), r.seconds()))});
  // Every tick that the recording has is what would be sent without reduction.
  const std::string all_updates = r.ticks.left_out() == 0 ? fmt::format("{} per second", r.tick_rate) : "one per tick recorded";
  table.row({fmt::format("  fewer than {} and object", all_updates),
             percent(1 - per(static_cast<double>(t.updates), static_cast<double>(r.ticks.count() * r.moving)))});
  const Rates payload = rates(r, 0), datagram = rates(r, kUdpHeader);
  table.heading({"size", "payload", "with UDP/IPv4"});
  table.row({"  bit/s", fmt::format("{:.0f}", payload.bits_per_s), fmt::format("{:.0f}", datagram.bits_per_s)});
  table.row(
      {"  bytes per packet", fmt::format("{:.2f}", payload.bytes_per_packet), fmt::format("{:.2f}", datagram.bytes_per_packet)});
  table.row(
      {"  bytes per update", fmt::format("{:.2f}", payload.bytes_per_update), fmt::format("{:.2f}", datagram.bytes_per_update)});
  table.row({"  smaller than raw 24-byte states", percent(payload.saved_24), percent(datagram.saved_24)});
  table.row({"  smaller than raw 48-byte states", percent(payload.saved_48), percent(datagram.saved_48)});
}

std::string rule_name(const RigidTriggers& b) {
  switch (b.haptic) {
    case HapticRule::off:
      return "off";
    case HapticRule::isotropic:
      return percent(b.weber_fraction);
    case HapticRule::cone:
      return fmt::format("{}, {:.3g} deg", percent(b.weber_fraction), b.cone_angle / kDegree);
    case HapticRule::fixed:
      return fmt::format("{:.3g} mm, {:.3g} deg", 1e3 * b.fixed_position, b.fixed_rotation / kDegree);
  }
  return {};
}

void error_row(Table& table, const Report& r, const std::string& name, const std::string& bound, const ErrorSeries& s,
               double unit) {
  // five digits: a maximum just inside its bound must not read as the bound
  table.row({name, bound, significant(s.rms() / unit), significant(s.max() / unit, 5), fmt::to_string(s.ticks_over()),
             percent(per(static_cast<double>(s.ticks_over()), static_cast<double>(s.ticks()))),
             fmt::format("{:.0f}", 1e3 * static_cast<double>(s.longest_run()) / r.tick_rate)});
}

bool has_errors(const Fidelity& f) { return f.position().ticks() > 0 || f.rendered().ticks() > 0; }

void error_rows(Table& table, const Report& r) {
  const Fidelity& f = *r.fidelity;
  const RigidTriggers& b = f.bounds();
  table.heading({"error", "bound", "RMS", "max", "ticks over", "share", "longest [ms]"});
  if (f.position().ticks() > 0) {
    error_row(table, r, "  position [mm]", significant(1e3 * b.visual_position), f.position(), 1e-3);
    error_row(table, r, "  rotation [deg]", significant(b.visual_rotation / kDegree), f.rotation(), kDegree);
  }
  if (f.force().ticks() > 0) {
    if (b.haptic != HapticRule::off) error_row(table, r, "  contact force [N]", rule_name(b), f.force(), 1);
    error_row(table, r, "  contact force, perception [N]", "10..22 %", f.perceived(), 1);
  }
  if (f.rendered().ticks() > 0) error_row(table, r, "  rendered force, perception [N]", "10..22 %", f.rendered(), 1);
}

void time_row(Table& table, const Report& r, const std::string& step, const StepTimes& times) {
  if (times.empty()) return;
  table.row({"  " + step, duration(times.quantile(0.5)), duration(times.quantile(0.99)), duration(times.quantile(1)),
             fmt::format("{:.0f}", per(r.seconds(), times.total()))});
}

void time_rows(Table& table, const Report& r) {
  table.heading({"time", "p50", "p99", "max", "times real time"});
  for (const Report::Timing& t : r.timings) time_row(table, r, t.step, t.times);
  for (const MeshReport& mesh : r.meshes) {
    time_row(table, r, "encode " + mesh.name + ", per frame", mesh.encode);
    time_row(table, r, "decode " + mesh.name + ", per packet", mesh.decode);
  }
}

Table summary(const Report& r) {
  Table table;
  table.heading({r.command});
  for (const auto& [role, path] : r.files) table.row({fmt::format("  {:<8} {}", role, path)});
  if (r.tick_rate == 0) return table;
  const std::uint64_t left_out = r.ticks.left_out();
  const std::string some_of = left_out == 0 ? "" : fmt::format("{} of ", r.ticks.count());
  std::string scope = fmt::format("  {:<8} {}{} at {} Hz ({:.3f} s), {}", "scope", some_of, counted(r.ticks.length(), "tick"),
                                  r.tick_rate, r.seconds(), counted(r.objects, "object"));
  if (r.users > 0) scope += ", " + counted(r.users, "user");
  table.row({scope});
  if (left_out > 0) {
    table.row({fmt::format("  {:<8} no sample at {} between the first and the last; seconds and rates include their time", "gaps",
                           counted(left_out, "tick"))});
  }
  for (const auto& [name, text] : r.notes) table.row({fmt::format("  {:<8} {}", name, text)});
  return table;
}

void print_text(const Report& r, std::FILE* out) {
  summary(r).print(out);
  fmt::print(out, "\n");
  Table figures;
  if (r.traffic) traffic_rows(figures, r);
  if (r.fidelity && has_errors(*r.fidelity)) error_rows(figures, r);
  for (const MeshReport& mesh : r.meshes) mesh_rows(figures, mesh, r.seconds());
  if (!r.timings.empty() || !r.meshes.empty()) time_rows(figures, r);
  figures.print(out);
  if (r.fidelity && r.fidelity->rendered().ticks() > 0) {
    fmt::print(
        out,
        "\nRendered force: what the hand felt beside the server's force. Its ticks over 10..22 % may be noticed; unlike the "
        "bounds above,\nno rule of the codec limits it, as the hand moves on what it feels.\n");
  }
}

Json rates_json(const Rates& x) {
  return {{"bit_per_s", x.bits_per_s},
          {"bytes_per_packet", x.bytes_per_packet},
          {"bytes_per_update", x.bytes_per_update},
          {"reduction_from_24_byte_states", x.saved_24},
          {"reduction_from_48_byte_states", x.saved_48}};
}

Json traffic_json(const Report& r) {
  const Traffic& t = *r.traffic;
  Json packets;
  for (std::size_t i = kReasons.size(); i-- > 0;) {
    packets[kReasons[i]] = {{"number", t.packets[i]}, {"per_s", per(static_cast<double>(t.packets[i]), r.seconds())}};
  }
  packets["all"] = {{"number", t.all_packets()}, {"per_s", per(static_cast<double>(t.all_packets()), r.seconds())}};
  return {{"packets", packets},
          {"key_packets", t.keys},
          {"updates", t.updates},
          {"bytes", t.bytes},
          {"reduction_of_updates", 1 - per(static_cast<double>(t.updates), static_cast<double>(r.ticks.count() * r.moving))},
          {"payload", rates_json(rates(r, 0))},
          {"with_udp_ipv4", rates_json(rates(r, kUdpHeader))}};
}

Json error_json(const Report& r, const ErrorSeries& s) {
  return {{"rms", s.rms()},
          {"max", s.max()},
          {"ticks", s.ticks()},
          {"ticks_over", s.ticks_over()},
          {"share_over", per(static_cast<double>(s.ticks_over()), static_cast<double>(s.ticks()))},
          {"longest_run_s", static_cast<double>(s.longest_run()) / r.tick_rate}};
}

Json errors_json(const Report& r) {
  const Fidelity& f = *r.fidelity;
  Json out;
  if (f.position().ticks() > 0) {
    out["position_m"] = error_json(r, f.position());
    out["position_m"]["bound"] = f.bounds().visual_position;
    out["rotation_rad"] = error_json(r, f.rotation());
    out["rotation_rad"]["bound"] = f.bounds().visual_rotation;
  }
  if (f.force().ticks() > 0) {
    if (f.bounds().haptic != HapticRule::off) {
      out["contact_force_N"] = error_json(r, f.force());
      out["contact_force_N"]["bound"] = rule_name(f.bounds());
      out["contact_force_N"]["worst_ratio"] = f.worst_haptic_ratio();
    }
    out["contact_force_perception_N"] = error_json(r, f.perceived());
  }
  if (f.rendered().ticks() > 0) out["rendered_force_perception_N"] = error_json(r, f.rendered());
  return out;
}

Json to_json(const Report& r) {
  Json out{{"schema", "tactus.report/1"}, {"command", r.command}};
  for (const auto& [role, path] : r.files) out["files"][role] = path;
  out["tick_rate"] = r.tick_rate;
  out["ticks"] = r.ticks.count();
  out["ticks_left_out"] = r.ticks.left_out();
  out["seconds"] = r.seconds();
  out["objects"] = r.objects;
  out["users"] = r.users;
  for (const auto& [name, text] : r.notes) out["notes"][name] = text;
  if (r.traffic) out["traffic"] = traffic_json(r);
  if (r.fidelity && has_errors(*r.fidelity)) out["error"] = errors_json(r);
  for (const MeshReport& mesh : r.meshes) out["meshes"].push_back(mesh_json(mesh, r.seconds()));
  for (const Report::Timing& t : r.timings) {
    if (t.times.empty()) continue;
    out["time"].push_back({{"step", t.step},
                           {"count", t.times.count()},
                           {"p50_s", t.times.quantile(0.5)},
                           {"p99_s", t.times.quantile(0.99)},
                           {"max_s", t.times.quantile(1)},
                           {"real_time_factor", per(r.seconds(), t.times.total())}});
  }
  return out;
}

}  // namespace

void Report::describe(const TraceInfo& info) {
  tick_rate = info.tick_rate;
  objects = info.objects.size();
  users = info.users.size();
  moving = static_cast<std::uint64_t>(
      std::count_if(info.objects.begin(), info.objects.end(), [](const TraceObject& o) { return o.dof != Dof::none; }));
}

void add_meshes(const TraceInfo& info, const MeshArguments& meshes, const TriggerArguments& triggers, Report& report) {
  for (const TraceMesh& mesh : info.meshes) {
    report.meshes.push_back({.name = mesh.name, .vertices = mesh.rest.vertices.size()});
    report.meshes.back().traffic.emplace();
    report.meshes.back().fidelity.emplace(mesh.rest, meshes.thresholds(triggers), meshes.rings(), GridExponents{}.position);
  }
}

void print(const Report& report, const CommonOptions& options, Destination destination) {
  std::FILE* out = destination == Destination::standard_output ? stdout : stderr;
  if (options.json) {
    fmt::print(out, "{}\n", to_json(report).dump(2));
  } else if (!options.quiet) {
    print_text(report, out);
  }
}

}  // namespace tactus::cli
