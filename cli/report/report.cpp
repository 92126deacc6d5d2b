// SPDX-License-Identifier: Apache-2.0
#include "cli/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <tactus/base/shown.h>
#include "cli/report/figures.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

void traffic_rows(Table& table, const Report& r) {
  const RateMetrics& t = *r.traffic;
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
  const std::string all_updates = r.ticks.left_out() == 0 ? fmt::format("{} /s", r.tick_rate) : "recorded ticks";
  table.row({fmt::format("  update reduction vs {}", all_updates),
             percent(1 - per(static_cast<double>(t.updates), static_cast<double>(r.ticks.count() * r.moving)))});
  const RigidRates payload = rigid_rates(r, 0), datagram = rigid_rates(r, kUdpHeader);
  table.heading({"size", "payload", "with UDP/IPv4"});
  table.row({"  bit/s", fmt::format("{:.0f}", payload.bits_per_s), fmt::format("{:.0f}", datagram.bits_per_s)});
  table.row(
      {"  bytes per packet", fmt::format("{:.2f}", payload.bytes_per_packet), fmt::format("{:.2f}", datagram.bytes_per_packet)});
  table.row(
      {"  bytes per update", fmt::format("{:.2f}", payload.bytes_per_update), fmt::format("{:.2f}", datagram.bytes_per_update)});
  table.row({"  compression vs 24-byte states", percent(payload.saved_24), percent(datagram.saved_24)});
  table.row({"  compression vs 48-byte states", percent(payload.saved_48), percent(datagram.saved_48)});
}

void load_rows(Table& table, const LoadRates& t, double seconds) {
  table.heading({"loads", "number", "per second", "payload [bit/s]"});
  table.row({"  packets", fmt::to_string(t.packets), fmt::format("{:.2f}", per(static_cast<double>(t.packets), seconds)),
             fmt::format("{:.0f}", 8 * per(static_cast<double>(t.bytes), seconds))});
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
    case HapticRule::perceptual:
      return fmt::format("{:.3g}..{:.3g} %", 10 * b.perceptual_share, 22 * b.perceptual_share);
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

void error_rows(Table& table, const Report& r, const ErrorMetrics& f, const std::string& of) {
  const RigidTriggers& b = f.bounds();
  table.heading({"error" + of, "bound", "RMS", "max", "ticks over", "share", "longest [ms]"});
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
  std::vector<std::string> cells{"  " + step};
  for (const TimeOf which : {TimeOf::wall, TimeOf::cpu})
    for (const double share : {0.5, 0.99, 1.0}) cells.push_back(duration(times.quantile(which, share)));
  cells.push_back(fmt::format("{:.0f}", per(r.seconds(), times.total(TimeOf::wall))));
  table.row(std::move(cells));
}

void time_rows(Table& table, const Report& r) {
  table.heading({"time", "p50", "p99", "max", "CPU p50", "CPU p99", "CPU max", "times real time"});
  for (const Timing& t : r.timings) time_row(table, r, t.label, t.times);
  for (const MeshReport& mesh : r.meshes) {
    time_row(table, r, "encode " + mesh.name + ", per frame", mesh.encode);
    time_row(table, r, "decode " + mesh.name + ", per packet", mesh.decode);
  }
}

/// The stream as a whole: its header is sent once.
void stream_rows(Table& table, const Report& r) {
  const auto [bytes, packets] = r.bytes_and_packets();
  const std::uint64_t header = r.stream->header_bytes;
  table.heading({"stream", "payload", "with UDP/IPv4"});
  table.row({"  header bytes", fmt::to_string(header)});
  if (r.stream->file_bytes) table.row({"  file bytes", fmt::to_string(*r.stream->file_bytes)});
  const auto rate = [&](std::uint64_t all) { return fmt::format("{:.0f}", 8 * per(static_cast<double>(all), r.seconds())); };
  table.row({"  bit/s with the header, over this length", rate(bytes + header), rate(bytes + header + packets * kUdpHeader)});
}

/// Long texts go on below, between words.
void note_row(Table& table, std::string name, std::string text) {
  constexpr std::size_t kWidth = 120;
  while (text.size() > kWidth) {
    const std::size_t end = text.rfind(' ', kWidth);
    if (end == std::string::npos || end == 0) break;
    table.row({fmt::format("  {:<8} {}", std::exchange(name, ""), text.substr(0, end))});
    text.erase(0, end + 1);
  }
  table.row({fmt::format("  {:<8} {}", name, text)});
}

std::string step_error(const DeformableReport& d) {
  constexpr std::uint64_t kFew = 10;
  if (d.samples < kFew) return fmt::format("of one step: n = {} is too few to tell", d.samples);
  return fmt::format("{:.2g} of one step, relative (median of {}), at most {:.2g}", d.error_p50, d.samples, d.error_max);
}

void note_rows(Table& table, const Report& r) {
  if (r.segments)
    note_row(table, "content", fmt::format("{} in {}", counted(r.ticks.count(), "row"), counted(*r.segments, "segment")));
  for (const MeshReport& mesh : r.meshes) {
    if (mesh.triangles == 0) continue;
    std::string text =
        fmt::format("{}: {}, {}", mesh.name, counted(mesh.vertices, "vertex"), counted(mesh.triangles, "triangle"));
    if (mesh.frames > 0) text += fmt::format(", {}, one every {:.6g} ms", counted(mesh.frames, "frame"), 1e3 * mesh.frame_period);
    note_row(table, "content", text);
  }
  if (r.seed) note_row(table, "seed", fmt::to_string(*r.seed));
  constexpr std::array kWays{"applies updates at once", "eases into updates", "interpolates"};
  if (r.client) note_row(table, "client", kWays[static_cast<std::size_t>(*r.client)]);
  for (const DeformableReport& d : r.deformables) {
    note_row(table, "object", fmt::format("{}, {}, deformed every {:g} ms", d.name, counted(d.vertices, "vertex"), 1e3 * d.step));
    note_row(table, "method", fmt::format("{}: {}", d.method, d.reason));
    if (d.samples == 0) continue;
    note_row(table, "error", step_error(d));
    note_row(table, "energy",
             fmt::format("spurious gain over the whole run: {:+.2g} % of the work of all forces", 100 * d.energy_gained));
  }
  for (const TouchReport& t : r.touches) {
    note_row(table, "touch",
             fmt::format("{}: {}, {:.1f} % of the ticks, at most {:.2f} N, least energy of a contact {:.2g} mJ", t.user,
                         counted(t.contacts, "contact"), 100 * t.share, t.largest_force, 1e3 * t.lowest_energy));
  }
  for (const NetworkReport& user : r.networks) note_row(table, "network", network_note(user));
  if (!r.bounds_from.empty())
    note_row(table, "bounds",
             r.bounds_from == "stream"    ? "declared by the stream"
             : r.bounds_from == "options" ? "as typed"
                                          : "the defaults");
  for (const std::string& warning : r.warnings) note_row(table, "warning", warning);
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
  note_rows(table, r);
  return table;
}

void print_text(const Report& r, std::FILE* out) {
  summary(r).print(out);
  fmt::print(out, "\n");
  Table figures;
  if (r.traffic) traffic_rows(figures, r);
  if (r.loads) load_rows(figures, *r.loads, r.seconds());
  if (r.fidelity && has_errors(*r.fidelity)) error_rows(figures, r, *r.fidelity, "");
  for (const NetworkReport& user : r.networks) {
    network_rows(figures, user, r.seconds());
    const std::string where = " at " + user.user + ", against the tick shown";
    if (has_errors(user.errors)) error_rows(figures, r, user.errors, where);
    for (const MeshReport& mesh : user.meshes) mesh_rows(figures, mesh, r.seconds(), where);
  }
  for (const MeshReport& mesh : r.meshes) mesh_rows(figures, mesh, r.seconds());
  if (r.stream) stream_rows(figures, r);
  if (!r.timings.empty() || !r.meshes.empty()) time_rows(figures, r);
  figures.print(out);
  if (!r.bounds_from.empty()) {
    const std::string broken = broken_bounds(r);
    fmt::print(out, "\n{}\n", broken.empty() ? "All bounds hold." : "Bounds are broken: " + broken + ".");
    if (const std::string missing = missing_force_bound(r); !missing.empty()) fmt::print(out, "{}\n", missing);
  }
  if (r.fidelity && r.fidelity->rendered().ticks() > 0) {
    fmt::print(out,
               "\nRendered force: the force at the hand compared with the server's force. Errors of more than 10..22 % may be "
               "perceptible.\nNo rule of the codec limits this error, because the hand moves under the force that it feels.\n");
  }
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

std::string missing_force_bound(const Report& r) {
  if (!r.fidelity || r.fidelity->bounds().haptic == HapticRule::off) return {};
  std::vector<std::string> users = r.fidelity->unbound_users();
  if (users.empty()) return {};
  for (std::string& user : users) user = shown(user);
  return fmt::format("No force bound: the recording has forces of user {} and no contacts; declare them with --contact.",
                     fmt::join(users, ", "));
}

Outcome verdict(const Report& r, const std::string& file) {
  const std::string broken = broken_bounds(r);
  if (broken.empty()) return {};
  Failure failure{file + ": bounds are broken: " + broken, ""};
  failure.cause = Failure::Cause::bound;
  failure.file = file;
  return tl::unexpected(std::move(failure));
}

RigidRates rigid_rates(const Report& r, std::uint64_t header) {
  const RateMetrics& t = *r.traffic;
  const auto packets = static_cast<double>(t.all_packets());
  const double bytes = static_cast<double>(t.bytes) + packets * static_cast<double>(header);
  // Without reduction: one packet per tick with every moving object's state, raw.
  const auto raw = [&](std::uint64_t state) { return static_cast<double>(r.ticks.count() * (r.moving * state + header)); };
  return {8 * per(bytes, r.seconds()), per(bytes, packets), per(bytes, static_cast<double>(t.updates)), 1 - per(bytes, raw(24)),
          1 - per(bytes, raw(48))};
}

bool has_errors(const ErrorMetrics& f) { return f.position().ticks() > 0 || f.rendered().ticks() > 0; }

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
  std::FILE* out = destination == Destination::standard_output ? stdout : stderr;
  if (options.json) {
    fmt::print(out, "{}\n", to_json(report));
  } else if (!options.quiet) {
    print_text(report, out);
  }
}

}  // namespace tactus::cli
