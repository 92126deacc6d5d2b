// SPDX-License-Identifier: Apache-2.0
/// Points of `tactus reproduce` for chapter 4 of the thesis: delay.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstring>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include <tactus/sim/deformable/stiffness_map.h>
#include <tactus/sim/link/link.h>
#include <tactus/sim/transparency/transparency.h>
#include "lab/study/delay.h"
#include "lab/study/program/points.h"

namespace tactus::study {
namespace {

namespace library = sim::study;

constexpr std::size_t kSparse = 100;  // [ticks] between the round trips that are written

Json ticks_of(const std::vector<library::DelayTick>& ticks) {
  Json force = Json::array(), stiffness = Json::array(), round_trip = Json::array();
  for (const library::DelayTick& tick : ticks) {
    force.push_back(tick.client);
    stiffness.push_back(tick.stiffness);
    round_trip.push_back(tick.round_trip);
  }
  return {{"force_N", std::move(force)}, {"stiffness_N_per_m", std::move(stiffness)}, {"round_trip_s", std::move(round_trip)}};
}

Json effect_json(const std::vector<library::DelayTick>& delayed, const std::vector<library::DelayTick>& reference, double weber) {
  const library::DelayEffect e = library::effect_of(delayed, reference, weber);
  Json round_trips = Json::array();
  for (std::size_t tick = 0; tick < delayed.size(); tick += kSparse) round_trips.push_back(delayed[tick].round_trip);
  return {{"mean_N", e.mean},
          {"reference_mean_N", e.reference_mean},
          {"peak_N", e.peak},
          {"reference_peak_N", e.reference_peak},
          {"outside", e.outside},
          {"rms", e.rms},
          {"lowest_energy_J", e.lowest_energy},
          {"round_trip_s_each_100_ticks", std::move(round_trips)}};
}

/// Devices of users who push the first object side by side at constant speed, in place of their hands.
library::DevicePaths constant_speed(const sim::Scene& scene, double speed) {
  library::DevicePaths paths;
  const double face = scene.objects[0].pose.position.x - scene.objects[0].size.x / 2;
  const auto ticks = static_cast<std::size_t>(std::llround(scene.duration / sim::kTick));
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    const double t = sim::kTick * static_cast<double>(tick);
    std::vector<DeviceSample>& devices = paths.emplace_back();
    for (const sim::SceneUser& user : scene.users)
      devices.push_back({.position = {face - 0.001 + speed * t, user.start.y, user.start.z}});
  }
  return paths;
}

/// [m/s] at which two users who push the first object do not notice a round trip.   4.31
double unnoticed_speed(const sim::Scene& scene, double round_trip, double weber) {
  const sim::SceneObject& block = scene.objects[0];
  const double friction = block.friction * block.mass * norm(scene.gravity) / 2, stiffness = scene.touch->stiffness;
  const double damping = sim::damping_of_factor(block.mass, block.damping, sim::kTick) / 2;
  return weber * friction / (stiffness * round_trip - weber * damping);
}

sim::MsdObject msd_of(Request part) {
  const sim::MsdObject out{part.get<double>("stiffness_N_per_m"), part.get<double>("damping_Ns_per_m"),
                           part.get<double>("mass_kg")};
  part.check_all_known();
  return out;
}

std::vector<double> magnitudes(const std::vector<double>& omegas, auto&& impedance) {
  std::vector<double> out;
  for (const double omega : omegas) out.push_back(std::abs(impedance(omega)));
  return out;
}

Json rigid_impedance(Request& request) {
  const auto omegas = request.get<std::vector<double>>("omega_rad_per_s");
  const auto round_trip = request.get<double>("round_trip_s");
  sim::RigidCoupling coupling{.mass = request.get<double>("mass_kg"),
                              .damping = request.get<double>("damping_Ns_per_m"),
                              .server_stiffness = request.get<double>("stiffness_N_per_m"),
                              .forward = round_trip / 2,
                              .backward = round_trip / 2};
  request.check_all_known();
  const double reduced =
      sim::reduced_stiffness({.velocity = 1, .damping = coupling.damping}, coupling.server_stiffness, round_trip);
  const auto client = [&](double stiffness) {
    coupling.client_stiffness = stiffness;
    return magnitudes(omegas, [&](double omega) { return sim::force_by_velocity(coupling, omega, sim::DelayModel::exact); });
  };
  return {{"reduced_stiffness_N_per_m", reduced},
          {"without_Ns_per_m", client(coupling.server_stiffness)},
          {"with_Ns_per_m", client(reduced)}};
}

Json deformable_impedance(Request& request) {
  const auto omegas = request.get<std::vector<double>>("omega_rad_per_s");
  const auto round_trip = request.get<double>("round_trip_s");
  const auto weber = request.get("weber", 0.1);
  const sim::MsdObject object = msd_of(request.part("msd"));
  const auto stiffness = request.get<double>("stiffness_N_per_m");
  const sim::DeformableCoupling coupling{.object_stiffness = object.stiffness,
                                         .object_damping = object.damping,
                                         .object_mass = object.mass,
                                         .client_stiffness = request.get("client_stiffness_N_per_m", stiffness),
                                         .client_damping = request.get<double>("client_damping_Ns_per_m"),
                                         .server_stiffness = stiffness};
  request.check_all_known();
  Json reduced = Json::array(), undamped = Json::array(), tolerable = Json::array();
  for (const double omega : omegas) {
    const bool is_near = omega * round_trip < std::numbers::pi;  // of equations 4.46 and 4.47
    reduced.push_back(is_near ? Json(sim::reduced_stiffness(coupling, omega, round_trip)) : Json(nullptr));
    undamped.push_back(is_near ? Json(sim::reduced_stiffness_undamped(coupling, omega, round_trip)) : Json(nullptr));
    const auto delay = sim::tolerable_delay(coupling, omega, weber);
    tolerable.push_back(delay ? Json(*delay) : Json(nullptr));
  }
  return {
      {"client_Ns_per_m", magnitudes(omegas, [&](double omega) { return sim::client_impedance(coupling, omega, round_trip); })},
      {"slow_client_Ns_per_m",
       magnitudes(omegas, [&](double omega) { return sim::slow_client_impedance(coupling, omega, round_trip); })},
      {"server_Ns_per_m", magnitudes(omegas, [&](double omega) { return sim::server_impedance(coupling, omega); })},
      {"follows_slowly", sim::follows_slowly(coupling)},
      {"reduced_stiffness_N_per_m", std::move(reduced)},
      {"reduced_stiffness_undamped_N_per_m", std::move(undamped)},
      {"tolerable_delay_s", std::move(tolerable)}};
}

/// [s] of datagrams sent each 10 ms and answered at once, in the order of their arrival.
std::vector<double> round_trips(const sim::LinkOptions& there, std::uint32_t count) {
  constexpr sim::Microseconds kStep = 10'000, kNever = INT64_MAX;
  sim::LinkOptions back = there;
  back.seed = there.seed + 1;
  auto up = need(sim::Link::create(there), "link");
  auto down = need(sim::Link::create(back), "link");
  std::vector<double> out;
  for (std::uint32_t sent = 0; out.size() < count;) {
    const sim::Microseconds send = sent < count ? kStep * sent : kNever;
    const sim::Microseconds now = std::min({send, up.next().value_or(kNever), down.next().value_or(kNever)});
    if (now == kNever) break;
    while (const auto arrival = down.poll(now)) {
      std::uint32_t number = 0;
      std::memcpy(&number, arrival->bytes.data(), sizeof number);
      out.push_back(1e-3 * static_cast<double>(now - kStep * number));
    }
    while (const auto arrival = up.poll(now)) down.send(now, arrival->bytes);
    if (now < send) continue;
    std::array<std::uint8_t, sizeof sent> bytes{};
    std::memcpy(bytes.data(), &sent, sizeof sent);
    up.send(now, bytes);
    ++sent;
  }
  return out;
}

}  // namespace

Json touch_point(Request& request) {
  sim::Scene scene = scene_of(request);
  if (request.has("msd")) {
    if (scene.msds.empty()) refuse_request(scene.name + ": there is no one-dimensional object", "Leave \"msd\" out.");
    scene.msds[0].object = msd_of(request.part("msd"));
    scene.msds[0].rate = 1;
    scene.msds[0].touch_damping = 0;
  }
  const auto seed = request.get<std::uint64_t>("seed", 1);
  sim::LinkOptions link = link_of(request, "link");
  link.seed = seed;
  const auto weber = request.get("weber", 0.1);
  const auto clients = request.get<std::vector<std::string>>("clients");
  const bool wants_ticks = request.get("ticks", false);
  const bool is_constant = request.has("unnoticed_round_trip_s");
  double speed = 0;
  library::DevicePaths paths;
  if (is_constant) {
    if (scene.objects.empty()) refuse_request(scene.name + ": there is no rigid object", "Leave \"unnoticed_round_trip_s\" out.");
    scene.duration = request.get("duration_s", scene.duration);  // longer than the scene, too: there are no hands
    speed = unnoticed_speed(scene, request.get<double>("unnoticed_round_trip_s"), weber);
    paths = constant_speed(scene, speed);
  }
  request.check_all_known();
  const auto run = [&](library::DelayCase one) {
    one.seed = seed;
    if (is_constant) one.paths = &paths;
    return need(library::run_delayed(scene, one));
  };
  const library::DelayRun reference = run({.is_local = true});
  Json out{{"scene", scene.name}, {"users", Json::array()}, {"runs", Json::array()}};
  if (is_constant) out["speed_m_per_s"] = speed;
  for (const sim::SceneUser& user : scene.users) out["users"].push_back(user.name);
  const auto add_ticks = [&](Json& to, const library::DelayRun& of) {
    for (const auto& ticks : of.users) to["ticks"].push_back(ticks_of(ticks));
  };
  if (wants_ticks) add_ticks(out["reference"], reference);
  for (const std::string& name : clients) {
    if (name != "none" && name != "stiffness") refuse_request("there are no clients \"" + name + "\"", "Give none or stiffness.");
    library::DelayCase one{.link = link};
    if (name == "stiffness") one.compensation.emplace();
    const library::DelayRun made = run(one);
    Json result{{"clients", name}, {"users", Json::array()}};
    for (std::size_t i = 0; i < scene.users.size(); ++i)
      result["users"].push_back(effect_json(made.users[i], reference.users[i], weber));
    if (wants_ticks) add_ticks(result, made);
    out["runs"].push_back(std::move(result));
  }
  return out;
}

Json press_point(Request& request) {
  sim::Pressing pressing{.object = msd_of(request.part("msd")),
                         .stiffness = request.get<double>("stiffness_N_per_m"),
                         .client_damping = request.get<double>("client_damping_Ns_per_m"),
                         .frequency = request.get("frequency_Hz", 0.5),
                         .duration = request.get<double>("duration_s")};
  if (request.has("compensation")) pressing.compensation = request.get<double>("compensation");
  for (const Json& one : request.get<std::vector<Json>>("users")) {
    Request user(one);
    const auto round_trip = user.get<std::uint32_t>("round_trip_ms");
    sim::PressingUser& added = pressing.users.emplace_back();
    added.to_server = round_trip / 2;
    added.from_server = round_trip - round_trip / 2;
    for (const auto& [begin, hold, end, depth] : user.get<std::vector<std::array<double, 4>>>("presses"))
      added.presses.push_back({begin, hold, end, depth});
    user.check_all_known();
  }
  request.check_all_known();
  Json out{{"users", Json::array()}};
  const auto rendered = need(sim::press(pressing), "press");
  for (std::size_t i = 0; i < rendered.size(); ++i) {
    std::vector<double> depth;
    for (std::size_t tick = 0; tick < rendered[i].client.size(); ++tick)
      depth.push_back(sim::depth_of(pressing.users[i].presses, 1e-3 * static_cast<double>(tick), pressing.frequency));
    out["users"].push_back({{"client_N", rendered[i].client}, {"server_N", rendered[i].server}, {"depth_m", depth}});
  }
  return out;
}

Json impedance_point(Request& request) {
  const auto object = request.get<std::string>("object");
  if (object == "rigid") return rigid_impedance(request);
  if (object == "deformable") return deformable_impedance(request);
  refuse_request("\"object\": \"" + object + "\"", "Give rigid or deformable.");
}

Json round_trips_point(Request& request) {
  const sim::LinkOptions there = link_of(request, "link");
  const auto count = request.get<std::uint32_t>("count", 360'000);
  request.check_all_known();
  return {{"round_trip_ms", round_trips(there, count)}};
}

Json stiffness_map_point(Request& request) {
  const sim::Scene scene = scene_of(request);
  request.check_all_known();
  Json out{{"deformables", Json::array()}};
  for (const sim::SceneDeformable& object : scene.deformables) {
    const sim::StiffnessMap map = need(sim::stiffness_map(object), scene.name, object.name);
    Json vertices = Json::array();
    for (const Vec3& v : map.surface.vertices) vertices.push_back({v.x, v.y, v.z});
    out["deformables"].push_back({{"name", object.name},
                                  {"vertices_m", std::move(vertices)},
                                  {"triangles", map.surface.triangles},
                                  {"stiffness_N_per_m", map.stiffness}});
  }
  return out;
}

}  // namespace tactus::study
