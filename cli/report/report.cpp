// SPDX-License-Identifier: Apache-2.0
#include "cli/report/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <numeric>

#include <tactus/base/shown.h>
#include "cli/report/json.h"
#include "cli/report/notes.h"
#include "cli/report/table.h"

namespace tactus::cli {

// ==== step times ====

namespace {

std::int64_t cpu_now() noexcept {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return std::int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
}

/// Reading the CPU clock is a system call, longer than the shortest steps that are measured.
std::int64_t cost_of_reading() noexcept {
  std::int64_t least = INT64_MAX;
  for (int i = 0; i < 100; ++i) {
    const std::int64_t before = cpu_now();
    least = std::min(least, cpu_now() - before);
  }
  return least;
}

}  // namespace

Stopwatch::Stopwatch() noexcept : cpu_(cpu_now()), wall_(Clock::now()) {}

Cost Stopwatch::elapsed() const noexcept {
  const auto wall = Clock::now();
  const std::int64_t cpu = cpu_now();
  static const std::int64_t reading = cost_of_reading();
  return {std::chrono::duration_cast<std::chrono::nanoseconds>(wall - wall_).count(),
          std::max<std::int64_t>(0, cpu - cpu_ - reading)};
}

void StepTimes::add(Cost cost) {
  wall_ns_.push_back(cost.wall_ns);
  cpu_ns_.push_back(cost.cpu_ns);
}

double StepTimes::quantile(TimeOf which, double fraction) const {
  std::vector<std::int64_t> sorted = times(which);
  const auto rank = static_cast<std::size_t>(std::ceil(fraction * static_cast<double>(sorted.size())));
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(sorted.begin(), at, sorted.end());
  return 1e-9 * static_cast<double>(*at);
}

double StepTimes::total(TimeOf which) const noexcept {
  std::int64_t sum = 0;
  for (const std::int64_t t : times(which)) sum += t;
  return 1e-9 * static_cast<double>(sum);
}

// ==== report ====

namespace {

bool has_errors(const ErrorMetrics& f) { return f.position().ticks() > 0 || f.rendered().ticks() > 0; }

/// Errors of one quantity: of ticks, or of vertices in all frames.
Json series_json(std::uint64_t samples, std::uint64_t over, double mse, double max) {
  return {
      {"samples", samples},    {"over", over}, {"fraction_over", per(static_cast<double>(over), static_cast<double>(samples))},
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
    out["bounds"] = mesh_bounds_value(f.bounds(), f.rings(), mesh.guaranteed);
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
    out["step_error"] = {{"samples", d.samples}, {"of_motion", d.error_of_motion}, {"most_of_motion", d.error_most}};
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
          {"reordered", direction.reordered}};
}

Json network_json(const Report& r, const NetworkReport& user) {
  const auto seconds_of = [](auto microseconds) { return 1e-6 * static_cast<double>(microseconds); };
  Json out{{"user", user.user},
           {"up", direction_json(user.up, r.seconds())},
           {"down", direction_json(user.down, r.seconds())},
           {"shown_behind_s", per(user.delay_sum, static_cast<double>(user.shown))},
           {"playout_s", seconds_of(user.status.playout_delay)},
           {"ticks_not_shown", user.not_shown},
           {"ticks_without_full_force", user.without_force},
           {"packets_refused", user.status.traffic.packets_refused},
           {"wrong_states", user.down.traffic.wrong_states},
           {"bound_scale", bound_scaling_value(user.bound_scaling)}};
  if (const auto& trip = user.status.round_trip)
    out["round_trip_s"] = {
        {"smoothed", seconds_of(trip->smoothed)}, {"variation", seconds_of(trip->variation)}, {"least", seconds_of(trip->least)}};
  if (user.status.clock_offset) out["clock_offset_s"] = seconds_of(*user.status.clock_offset);
  out["bounds"] = bounds_value(user.errors.bounds());
  if (has_errors(user.errors)) out["error"] = errors_json(r, user.errors);
  for (const MeshReport& mesh : user.meshes) out["deformables"].push_back(mesh_json(mesh, r.seconds()));
  for (const auto& [name, times] :
       {std::pair("shapes", &user.shapes), std::pair("poses", &user.poses), std::pair("compensation", &user.compensation)})
    if (!times->empty()) out["time"][name] = time_value(*times, r.seconds());
  return out;
}

Json worst_json(const RigidReport::Worst& worst, const char* key) {
  Json out{{key, worst.value}};
  if (worst.object.empty()) return out;
  out["at_s"] = worst.at;
  out["object"] = worst.object;
  return out;
}

Json rigid_json(const RigidReport& r) {
  Json out{{"penetration", worst_json(r.penetration, "m")},
           {"drift", worst_json(r.drift, "m")},
           {"flight", worst_json(r.flight, "J")},
           {"contact_energy_J", r.contact_energy},
           {"momentum_N_s", r.momentum},
           {"residual", worst_json(r.residual, "m_s")},
           {"contact_steps", r.steps},
           {"contact_steps_again", r.again},
           {"contact_steps_unsolved", r.unsolved}};
  for (const RigidReport::Object& o : r.objects)
    out["objects"].push_back({{"name", o.name}, {"penetration_m", o.penetration}, {"drift_m", o.drift}, {"flight_J", o.flight}});
  return out;
}

Json difference_json(const CheckReport::Quantity& q, const std::string& name, const std::string& unit) {
  const auto rms = [&q](double square_sum) { return std::sqrt(per(square_sum, static_cast<double>(q.count))); };
  Json out{
      {name, q.name}, {"largest_" + unit, q.largest}, {"at_s", q.at}, {"rms_" + unit, rms(q.square_sum)}, {"of_" + unit, q.of}};
  if (!q.energy) return out;
  const std::string what = name == "user" ? "work" : "energy";
  out[what + "_J"] = q.energy->largest;
  out[what + "_rms_J"] = rms(q.energy->square_sum);
  out[what + "_of_J"] = q.energy->of;
  return out;
}

Json check_json(const CheckReport& c) {
  Json out{{"against", c.against}, {"cpu_s", c.cpu}};
  for (std::size_t i = 0; i < c.objects.size(); ++i) {
    if (c.objects[i].of == 0 && c.objects[i].largest == 0 && c.turns[i] == 0) continue;
    out["objects"].push_back(difference_json(c.objects[i], "name", "m"));
    out["objects"].back()["rotation_rad"] = c.turns[i];
  }
  for (const CheckReport::Quantity& user : c.users) out["users"].push_back(difference_json(user, "user", "N"));
  for (const CheckReport::Quantity& mesh : c.meshes) out["deformables"].push_back(difference_json(mesh, "name", "m"));
  return out;
}

/// What only some commands know.
void add_particulars(Json& out, const Report& r) {
  if (r.seed) out["seed"] = *r.seed;
  if (r.segments) out["segments"] = *r.segments;
  constexpr std::array kDisplays{"direct", "smoothed", "interpolated"};
  if (r.client) out["client"] = kDisplays[static_cast<std::size_t>(*r.client)];
  for (const DeformableReport& d : r.deformables) out["solvers"].push_back(solver_json(d));
  for (const CheckReport& check : r.checks) out["checks"].push_back(check_json(check));
  if (r.rigid) out["rigid"] = rigid_json(*r.rigid);
  for (const TouchReport& t : r.touches) {
    out["touches"].push_back({{"user", t.user},
                              {"contact_fraction", t.contact_fraction},
                              {"contacts", t.contacts},
                              {"contacts_most_in_a_second", t.most_in_a_second},
                              {"largest_force_N", t.largest_force},
                              {"largest_server_force_N", t.largest_server_force},
                              {"swing_m", t.swing},
                              {"lowest_energy_J", t.lowest_energy}});
  }
  for (const std::string& warning : r.warnings) out["warnings"].push_back(warning);
  if (!r.notes.empty()) out["notes"] = r.notes;
}

void add_verdict(Json& out, const Report& r) {
  if (!r.bounds_from.empty()) {
    const std::string broken = broken_bounds(r);
    out["bounds_from"] = r.bounds_from;
    out["bounds_held"] = broken.empty();
    const std::string missing = missing_force_bound(r);
    out["verdict"] =
        (broken.empty() ? "All bounds hold." : "Bounds are broken: " + broken + ".") + (missing.empty() ? "" : " ") + missing;
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
    if (mesh.fidelity && mesh.guaranteed)
      look(shown(mesh.name) + " at", mesh.fidelity->all().violations, mesh.fidelity->all().vertices, "vertex");
  return text;
}

std::string missing_force_bound(const Report& r) {
  if (!r.fidelity || r.fidelity->bounds().haptic == HapticRule::off) return {};
  return missing_force_bound(r.fidelity->unbound_users(), r.objects);
}

std::string missing_force_bound(std::vector<std::string> users, std::size_t objects, const std::string& declare) {
  if (users.empty()) return {};
  for (std::string& user : users) user = shown(user);
  if (objects == 0)
    return fmt::format(
        "No force bound: the recording has forces of user {} and no rigid object; `tactus bench signals` codes forces alone.",
        fmt::join(users, ", "));
  return fmt::format("No force bound: the recording has forces of user {} and no contacts; declare them with {}.",
                     fmt::join(users, ", "), declare);
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

void Report::add(const std::vector<ReadNote>& read) {
  for (std::string& text : texts_of(read)) notes.push_back(std::move(text));
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

// ==== json parts ====

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
          {"payload", at(0)},   {"with_udp_ipv4", at(kNumberedDatagram)}};
}

constexpr std::array<std::pair<const char*, std::uint64_t>, 2> kSizes{{{"payload", 0}, {"with_udp_ipv4", kNumberedDatagram}}};

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
  if (is_constant) out["weber_fraction"] = b.weber_fraction;
  if (b.haptic == HapticRule::perceptual) out["perceptual_fraction"] = b.perceptual_fraction;
  if (is_constant || b.haptic == HapticRule::perceptual) out["force_floor_N"] = b.force_floor;
  if (b.haptic == HapticRule::cone) out["haptic_angle_rad"] = b.cone_angle;
  if (b.haptic == HapticRule::fixed) {
    out["haptic_position_m"] = b.fixed_position;
    out["haptic_rotation_rad"] = b.fixed_rotation;
  }
  return out;
}

Value mesh_bounds_value(const DeformableThresholds& b, std::uint8_t rings, bool guaranteed) {
  Json out{{"position_m", b.visual},
           {"haptic_rule", b.weber_fraction ? "isotropic" : "off"},
           {"rings", rings},
           {"guaranteed", guaranteed}};
  if (b.weber_fraction) {
    out["weber_fraction"] = *b.weber_fraction;
    out["depth_floor_m"] = b.depth_floor;
  }
  return out;
}

Value bound_scaling_value(const BoundScaling& scaling) {
  return Json{{"largest", scaling.largest}, {"for_s", 1e-6 * static_cast<double>(scaling.time)}};
}

std::string error_json(const Failure& failure) {
  Json error{{"text", failure.text}};
  for (const auto& [name, value] :
       {std::pair("remedy", &Failure::remedy), std::pair("class", &Failure::error_class), std::pair("rule", &Failure::rule),
        std::pair("file", &Failure::file), std::pair("location", &Failure::location)})
    if (!(failure.*value).empty()) error[name] = failure.*value;
  return text_of_json({{"schema", "tactus.error/1"}, {"error", std::move(error)}});
}

}  // namespace tactus::cli
