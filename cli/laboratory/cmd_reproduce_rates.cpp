// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <vector>

#include <tactus/signal/force_signal.h>
#include <tactus/sim/random.h>
#include <tactus/sim/simulation.h>
#include <tactus/sim/user/hand.h>
#include "cli/laboratory/cmd_reproduce.h"
#include "cli/options/grip_option.h"
#include "cli/progress.h"
#include "cli/report/json_parts.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegree = std::numbers::pi / 180;

/// Packets of a run.
struct Rates {
  double all = 0;          ///< [1/s]
  double in_contact = 0;   ///< [1/s] of the time in contact
  double force_error = 0;  ///< [N] RMS, of what is felt against the server's force, in contact
};

/// Adds up a run, tick by tick.
class Counter {
 public:
  void add(const UserSample& user, std::size_t packets, const Vec3& felt) {
    ++ticks_;
    packets_ += packets;
    if (norm(user.server_force) == 0 && norm(felt) == 0) return;
    ++contact_;
    contact_packets_ += packets;
    const Vec3 error = felt - user.server_force;
    square_ += dot(error, error);
  }
  Rates rates() const {
    const auto per_second = [](std::size_t count, std::size_t ticks) {
      return ticks == 0 ? 0 : static_cast<double>(count) * sim::kTickRate / static_cast<double>(ticks);
    };
    return {per_second(packets_, ticks_), per_second(contact_packets_, contact_),
            contact_ == 0 ? 0 : std::sqrt(square_ / static_cast<double>(contact_))};
  }

 private:
  std::size_t ticks_ = 0, contact_ = 0, packets_ = 0, contact_packets_ = 0;
  double square_ = 0;
};

tl::expected<sim::Scene, Failure> scene_of(const char* name) {
  const auto path = sim::find_scene(name);
  if (!path) return refuse(path.error());
  auto scene = sim::load_scene(*path);
  if (!scene) return refuse(scene.error());
  return *scene;
}

RigidTriggers triggers_of(double p, const ReproduceOptions& options) {
  RigidTriggers out;
  out.weber_fraction = p;
  out.visual_position = 0.01 * options.length_unit;  // thesis 3.2.4.1
  out.visual_rotation = 4 * kDegree;
  return out;
}

/// The client renders what it is told of the object.
tl::expected<Rates, Failure> with_states(const sim::Scene& scene, const RigidTriggers& triggers, Interpolation interpolation,
                                         const ReproduceOptions& options, std::uint64_t seed) {
  sim::ChannelOptions channel;
  channel.coding.rigid = RigidProfile::thesis;
  channel.sender.triggers = triggers;
  channel.replica.interpolation = interpolation;
  auto simulation = sim::Simulation::create(scene, {.seed = seed, .grip = grip_of(options.grip), .channel = channel});
  if (!simulation) return refuse(scene.name, simulation.error());
  Counter counter;
  for (std::int64_t tick = 0; tick < simulation->ticks(); ++tick) {
    const auto packets = simulation->step();
    if (!packets) return refuse(scene.name, place_of_tick(tick), packets.error().error);
    const UserSample& user = simulation->frame().users[0];
    counter.add(user, packets->size(), user.force);
  }
  return counter.rates();
}

/// The server renders, and the hand feels what it is told of the force.
tl::expected<Rates, Failure> with_forces(const sim::Scene& scene, const ForceCoding& coding, const ReproduceOptions& options,
                                         std::uint64_t seed) {
  sim::SimulationOptions settings;
  settings.seed = seed;
  auto simulation = sim::Simulation::create(scene, settings);
  if (!simulation) return refuse(scene.name, simulation.error());
  auto sender = ForceSender::create(coding, sim::kTickRate);
  if (!sender) return refuse(scene.name, sender.error());
  ForceReceiver receiver(sim::kTickRate);
  sim::Random seeds(seed);
  sim::Hand hand(scene.users[0], grip_of(options.grip), seeds.next());
  std::vector<DeviceSample> devices(1);
  Counter counter;
  for (std::int64_t tick = 0; tick < simulation->ticks(); ++tick) {
    const Vec3 felt = receiver.force(tick);
    devices[0] = hand.step(felt, simulation->client_poses()[scene.users[0].object]);
    if (const auto stepped = simulation->step(devices); !stepped)
      return refuse(scene.name, place_of_tick(tick), stepped.error().error);
    const UserSample& user = simulation->frame().users[0];
    const auto sample = sender->encode(tick, user.server_force);
    if (!sample) return refuse(scene.name, place_of_tick(tick), sample.error());
    if (!sample->empty())
      if (const auto pushed = receiver.push(*sample); !pushed) return refuse(scene.name, place_of_tick(tick), pushed.error());
    counter.add(user, sample->empty() ? 0 : 1, receiver.force(tick));
  }
  return counter.rates();
}

struct Mean {
  double value = 0, deviation = 0;
};
Mean mean_of(const std::vector<double>& values) {
  Mean out;
  const auto n = static_cast<double>(values.size());
  for (const double value : values) out.value += value / n;
  double square = 0;
  for (const double value : values) square += (value - out.value) * (value - out.value);
  out.deviation = values.size() > 1 ? std::sqrt(square / (n - 1)) : 0;
  return out;
}

/// All seeds of one setting.
struct Summary {
  Mean all, in_contact, force_error;
};
template <class Run>
tl::expected<Summary, Failure> over_seeds(const ReproduceOptions& options, Run&& run) {
  std::vector<double> all, in_contact, force_error;
  for (std::uint64_t seed = 1; seed <= options.seeds; ++seed) {
    TACTUS_TRY(const Rates rates, run(seed));
    all.push_back(rates.all);
    in_contact.push_back(rates.in_contact);
    force_error.push_back(rates.force_error);
  }
  return Summary{mean_of(all), mean_of(in_contact), mean_of(force_error)};
}

std::string text_of(const Mean& mean, int digits = 1) {
  return fmt::format("{:.{}f} +- {:.{}f}", mean.value, digits, mean.deviation, digits);
}
Json json_of(const Mean& mean) { return {{"mean", mean.value}, {"standard_deviation", mean.deviation}}; }
Json json_of(const Summary& s) {
  return {{"packets_per_s", json_of(s.all)},
          {"packets_per_s_in_contact", json_of(s.in_contact)},
          {"force_error_rms_N", json_of(s.force_error)}};
}

Json head_of(const ReproduceOptions& options, const char* figure) {
  return {{"schema", "tactus.reproduce_rates/1"},
          {"figure", figure},
          {"seeds", options.seeds},
          {"length_unit_m", options.length_unit},
          {"grip", options.grip}};
}

}  // namespace

Outcome reproduce_architectures(const ReproduceOptions& options) {
  constexpr std::array kDeadbands{0.01, 0.02, 0.05, 0.08, 0.12, 0.18, 0.25, 0.35, 0.5};
  struct Row {
    double p;
    Summary states, hold, linear;
  };
  TACTUS_TRY(const sim::Scene scene, scene_of("push-1dof"));
  std::vector<Row> rows;
  {
    Progress progress("reproduce", kDeadbands.size(), options.common.progress());
    for (const double p : kDeadbands) {
      TACTUS_TRY(const Summary states, over_seeds(options, [&](std::uint64_t seed) {
                   return with_states(scene, triggers_of(p, options), Interpolation::none, options, seed);
                 }));
      const auto forces = [&](ForcePredictor predictor) {
        return over_seeds(options, [&](std::uint64_t seed) {
          return with_forces(scene, {.rule = ForceRule::weber, .predictor = predictor, .weber_fraction = p}, options, seed);
        });
      };
      TACTUS_TRY(const Summary hold, forces(ForcePredictor::hold));
      TACTUS_TRY(const Summary linear, forces(ForcePredictor::linear));
      rows.push_back({p, states, hold, linear});
      progress.update(rows.size());
    }
  }
  const bool is_left = std::ranges::all_of(rows, [](const Row& row) {
    return row.states.all.value < row.linear.all.value && row.states.all.value < row.hold.all.value;
  });
  if (options.common.json) {
    Json out = head_of(options, "fig3.6");
    out["scene"] = scene.name;
    for (const Row& row : rows)
      out["rows"].push_back({{"deadband", row.p},
                             {"states", json_of(row.states)},
                             {"forces_held", json_of(row.hold)},
                             {"forces_linear", json_of(row.linear)}});
    out["states_need_fewer_packets"] = is_left;
    fmt::print("{}\n", text_of_json(out));
    return {};
  }
  fmt::print(
      "Thesis figure 3.6: packets per second to a client that is sent object states (CS-State) or forces (CS-Force), {}, seeds 1 "
      "to {}\n"
      "One user here, two in the thesis, whose figure has no numbers.\n\n",
      scene.name, options.seeds);
  Table table;
  table.heading({"p", "CS-State", "CS-Force, linear", "CS-Force, hold", "felt error, state [N]", "linear [N]", "hold [N]"});
  for (const Row& row : rows)
    table.row({fmt::format("{:.0f} %", 100 * row.p), text_of(row.states.all), text_of(row.linear.all), text_of(row.hold.all),
               text_of(row.states.force_error, 3), text_of(row.linear.force_error, 3), text_of(row.hold.force_error, 3)});
  table.print(stdout);
  fmt::print("\nCS-State needs fewer packets than CS-Force at every p: {}\n", is_left ? "holds" : "does not hold");
  return {};
}

Outcome reproduce_adjusted(const ReproduceOptions& options) {
  struct Setting {
    const char* scene;
    Interpolation interpolation;
    double p, thesis;
  };
  constexpr std::array<Setting, 4> kSettings{{{"push-1dof", Interpolation::none, 0.074, 13},
                                              {"push-1dof", Interpolation::linear, 0.187, 7.5},
                                              {"rotate-6dof", Interpolation::none, 0.01, 230},
                                              {"rotate-6dof", Interpolation::linear, 0.037, 96}}};
  struct Row {
    Summary scene_hand, faster_hand;
  };
  std::vector<Row> rows;
  {
    Progress progress("reproduce", kSettings.size(), options.common.progress());
    for (const Setting& s : kSettings) {
      TACTUS_TRY(const sim::Scene scene, scene_of(s.scene));
      const auto with = [&](const sim::Scene& moved) {
        return over_seeds(options, [&](std::uint64_t seed) {
          return with_states(moved, triggers_of(s.p, options), s.interpolation, options, seed);
        });
      };
      TACTUS_TRY(const Summary scene_hand, with(scene));
      TACTUS_TRY(const Summary faster_hand, with(with_faster_hand(scene, options)));
      rows.push_back({scene_hand, faster_hand});
      progress.update(rows.size());
    }
  }
  const auto name = [](const Setting& s) { return s.interpolation == Interpolation::none ? "without" : "with"; };
  if (options.common.json) {
    Json out = head_of(options, "fig3.10");
    out["faster_hand"] = {{"pace", options.pace}, {"tremor_m", options.tremor}};
    for (std::size_t i = 0; i < rows.size(); ++i)
      out["rows"].push_back({{"scene", kSettings[i].scene},
                             {"interpolation", name(kSettings[i])},
                             {"deadband", kSettings[i].p},
                             {"thesis_packets_per_s", kSettings[i].thesis},
                             {"states", json_of(rows[i].scene_hand)},
                             {"states_faster_hand", json_of(rows[i].faster_hand)}});
    fmt::print("{}\n", text_of_json(out));
    return {};
  }
  fmt::print("Thesis figure 3.10: updates per second in contact, at the deadbands that its subjects chose, seeds 1 to {}\n{}\n\n",
             options.seeds, about_faster_hand(options));
  Table table;
  table.heading(
      {"experiment", "interpolation", "p", "updates/s in contact", "faster hand", "thesis", "over thesis", "faster hand"});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto over_thesis = [&](const Summary& row) {
      return fmt::format("{:.2f}", row.in_contact.value / kSettings[i].thesis);
    };
    const auto& [scene_hand, faster_hand] = rows[i];
    table.row({kSettings[i].scene, name(kSettings[i]), fmt::format("{:.1f} %", 100 * kSettings[i].p),
               text_of(scene_hand.in_contact), text_of(faster_hand.in_contact), fmt::format("{:g}", kSettings[i].thesis),
               over_thesis(scene_hand), over_thesis(faster_hand)});
  }
  table.print(stdout);
  return {};
}

}  // namespace tactus::cli
