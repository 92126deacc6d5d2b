// SPDX-License-Identifier: Apache-2.0
#include "lab/study/delay.h"

#include <algorithm>
#include <cmath>

#include <tactus/sim/link/session_network.h>
#include <tactus/sim/simulation.h>
#include <tactus/sim/user/passivity.h>

namespace tactus::sim::study {
namespace {

constexpr double kTouch = 0.02;      // [N] below it nothing counts as rendered
constexpr std::int64_t kFree = 100;  // [ticks] without force, then energy is counted anew

SimulationOptions options_of(const DelayCase& one) {
  SimulationOptions options{.seed = one.seed, .grip = {}, .channel = {}};
  if (one.is_local) return options;
  ChannelOptions& channel = options.channel.emplace();
  channel.own = one.own;
  channel.coding.rigid = RigidProfile::thesis;
  channel.sender.triggers = {.reduction = Reduction::none, .visual_position = 6e-3, .weber_fraction = 0.08};
  channel.sender.load = {.weber_fraction = 0.02, .force_floor = 0.5};
  channel.network = [link = one.link](SharedScene scene, std::size_t users,
                                      const SenderOptions& sender) -> Result<std::unique_ptr<Network>> {
    NetworkOptions network{.uplink = link, .downlink = link};
    network.downlink.seed += 1000;
    network.device.every_tick = true;
    if (link.gamma_mean == 0) network.playout.fixed = 0;
    TACTUS_TRY(auto made, SessionNetwork::create(std::move(scene), users, sender, network));
    return std::unique_ptr<Network>(std::move(made));
  };
  return options;
}

}  // namespace

tl::expected<DelayRun, Diagnostic> run_delayed(const Scene& scene, const DelayCase& one) {
  Scene asked = scene;
  asked.compensation = one.compensation;
  auto made = Simulation::create(asked, options_of(one));
  if (!made) return tl::unexpected(Diagnostic{.error = made.error()});
  Simulation simulation = std::move(*made);
  const std::size_t users = scene.users.size();
  DelayRun out{std::vector<std::vector<DelayTick>>(users), {}};
  std::vector<PassivityObserver> observers(users);
  std::vector<std::int64_t> free_since(users);
  for (std::int64_t tick = 0; tick < simulation.ticks(); ++tick) {
    const auto stepped = one.paths != nullptr ? simulation.step((*one.paths)[static_cast<std::size_t>(tick)]) : simulation.step();
    if (!stepped) return tl::unexpected(stepped.error());
    std::vector<DeviceSample>& devices = out.paths.emplace_back();
    for (std::size_t i = 0; i < users; ++i) {
      const UserSample& user = simulation.frame().users[i];
      devices.push_back(user.device);
      observers[i].arrive(user.device.position);
      if (user.force != Vec3{}) free_since[i] = tick;
      if (tick - free_since[i] >= kFree) observers[i].reset();
      observers[i].hold(user.force);
      out.users[i].push_back({.client = norm(user.force),
                              .server = norm(user.server_force),
                              .stiffness = simulation.stiffness(i),
                              .round_trip = simulation.round_trip(i),
                              .touched = simulation.touched_point(i),
                              .shown = simulation.watched(i),
                              .energy = observers[i].energy()});
    }
  }
  return out;
}

double quantile(std::vector<double>& values, double fraction) {
  if (values.empty()) return NAN;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

DelayEffect effect_of(const std::vector<DelayTick>& delayed, const std::vector<DelayTick>& reference, double weber) {
  DelayEffect out;
  std::vector<double> rendered, wanted;
  double error = 0, square = 0;
  std::size_t outside = 0;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const double f = delayed[i].client, r = reference[i].client;
    if (f > kTouch) rendered.push_back(f);
    error += (f - r) * (f - r);
    square += r * r;
    out.lowest_energy = std::min(out.lowest_energy, delayed[i].energy);
    if (r <= kTouch) continue;
    wanted.push_back(r);
    if (std::abs(f - r) > weber * r) ++outside;
  }
  const auto mean = [](const std::vector<double>& v) {
    double sum = 0;
    for (const double f : v) sum += f;
    return v.empty() ? 0 : sum / static_cast<double>(v.size());
  };
  const auto peak = [](std::vector<double>& v) { return v.empty() ? 0 : quantile(v, 0.99); };
  out.mean = mean(rendered);
  out.reference_mean = mean(wanted);
  out.peak = peak(rendered);
  out.reference_peak = peak(wanted);
  out.outside = wanted.empty() ? 0 : static_cast<double>(outside) / static_cast<double>(wanted.size());
  out.rms = square > 0 ? std::sqrt(error / square) : NAN;
  return out;
}

}  // namespace tactus::sim::study
