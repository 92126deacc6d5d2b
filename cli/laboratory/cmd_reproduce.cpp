// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/cmd_reproduce.h"
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include <tactus/metrics/errors.h>
#include <tactus/metrics/rates.h>
#include <tactus/receiver.h>
#include <tactus/sim/simulation.h>
#include "cli/laboratory/workers.h"
#include "cli/options/hand_option.h"
#include "cli/options/options_codec.h"
#include "cli/report/json_parts.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegree = std::numbers::pi / 180;

/// A row of thesis table 3.3. Lengths are in the thesis's virtual units.
struct Setting {
  const char* name;
  Reduction reduction;
  HapticRule rule;
  double p;
  double visual_length, visual_angle_deg;
  Interpolation interpolation;
  const char* thesis_rate;  ///< packets/s as the text of thesis 3.2.5.2 gives it; figure 3.14 itself has no numbers
};

constexpr auto kNone = Interpolation::none;
constexpr auto kLinear = Interpolation::linear;
constexpr std::array<Setting, 12> kSettings{{
    {"S_R7", Reduction::none, HapticRule::off, 0.08, 0.006, 2, kNone, "1000"},
    {"S_R1", Reduction::dead_reckoning, HapticRule::off, 0.08, 0.006, 2, kNone, "-"},
    {"S4_NI", Reduction::dead_reckoning, HapticRule::isotropic, 0.04, 0.006, 2, kNone, "42.6"},
    {"S8_NI", Reduction::dead_reckoning, HapticRule::isotropic, 0.08, 0.006, 2, kNone, "-"},
    {"S18_NI", Reduction::dead_reckoning, HapticRule::isotropic, 0.18, 0.006, 2, kNone, "-"},
    {"S30_NI", Reduction::dead_reckoning, HapticRule::isotropic, 0.30, 0.006, 2, kNone, "~25"},
    {"S4_WI", Reduction::dead_reckoning, HapticRule::isotropic, 0.04, 0.010, 4, kLinear, "28.6"},
    {"S8_WI", Reduction::dead_reckoning, HapticRule::isotropic, 0.08, 0.010, 4, kLinear, "-"},
    {"S18_WI", Reduction::dead_reckoning, HapticRule::isotropic, 0.18, 0.010, 4, kLinear, "-"},
    {"S30_WI", Reduction::dead_reckoning, HapticRule::isotropic, 0.30, 0.010, 4, kLinear, "12.3"},
    {"S_NIso", Reduction::dead_reckoning, HapticRule::cone, 0.18, 0.010, 4, kLinear, "18.2"},
    {"S_DR", Reduction::dead_reckoning, HapticRule::fixed, 0.08, 0.010, 4, kLinear, "33.6"},
}};

RigidTriggers triggers_of(const Setting& s, double length_unit) {
  RigidTriggers t;
  t.reduction = s.reduction;
  t.haptic = s.rule;
  t.weber_fraction = s.p;
  t.visual_position = s.visual_length * length_unit;
  t.visual_rotation = s.visual_angle_deg * kDegree;
  t.fixed_position *= length_unit;
  return t;
}

/// What one run yields; small and flat, so that it passes through a pipe.
struct Measured {
  FlatError failure{};
  double packets_per_s = 0, bytes_per_update = 0, bit_per_s = 0;
  std::uint64_t rule_violations = 0;    ///< ticks in which the predicted state breaks the haptic rule
  std::uint64_t visual_violations = 0;  ///< the same for the visual thresholds
  double shown_over = 0;                ///< share of ticks in contact in which what is shown breaks it
  double shown_worst = 0;               ///< how far: largest ratio of error and permitted error
  double over_jnd = 0;                  ///< share of ticks with a rendered force over the perceptual curve
  double contact = 0;                   ///< share of all ticks
};

Measured failed_at(std::int64_t tick, const Error& error) { return {.failure = FlatError::of(error, tick)}; }

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

/// The state as predicted, beside what the simulation's own client shows: a second client without smoothing.
Result<void> follow(Receiver& receiver, std::span<const Packet> packets, std::int64_t tick, std::span<Pose> poses) {
  for (const Packet& packet : packets) TACTUS_CHECK(receiver.push(packet.bytes));
  for (std::uint32_t i = 0; i < poses.size(); ++i)
    poses[i] = to_pose(receiver.replica().pose(i, tick), receiver.scene()->grid.position);
  return {};
}

Measured summary(const RateMetrics& traffic, const ErrorMetrics& predicted, const ErrorMetrics& shown, std::uint64_t ticks,
                 std::uint64_t visual_violations) {
  const double seconds = static_cast<double>(ticks) * sim::kTick;
  Measured out;
  out.packets_per_s = static_cast<double>(traffic.all_packets()) / seconds;
  out.bytes_per_update = share(traffic.bytes, traffic.updates);
  out.bit_per_s = 8 * static_cast<double>(traffic.bytes) / seconds;
  out.rule_violations = predicted.force().ticks_over();
  out.visual_violations = visual_violations;
  out.shown_over = share(shown.force().ticks_over(), shown.force().ticks());
  out.shown_worst = shown.worst_haptic_ratio();
  out.over_jnd = share(shown.rendered().ticks_over(), ticks);
  out.contact = share(shown.force().ticks(), ticks);
  return out;
}

Measured measure(const sim::Scene& scene, const Setting& setting, const RigidTriggers& triggers, sim::Grip grip,
                 std::uint64_t seed) {
  const sim::ChannelOptions channel{.sender = {.triggers = triggers, .deformable = {}, .policy = {}},
                                    .replica = {.interpolation = setting.interpolation},
                                    .coding = {.rigid = RigidProfile::thesis}};
  auto simulation = sim::Simulation::create(scene, {.seed = seed, .grip = grip, .channel = channel});
  if (!simulation) return failed_at(0, simulation.error());
  auto predicting = Receiver::create(simulation->stream_scene());
  if (!predicting) return failed_at(0, predicting.error());
  const TraceInfo info = simulation->info();
  ErrorMetrics predicted(info, triggers), shown(info, triggers);
  RateMetrics traffic;
  std::vector<Pose> poses(info.objects.size());
  const std::int64_t ticks = simulation->ticks();
  std::uint64_t visual_violations = 0;
  for (std::int64_t tick = 0; tick < ticks; ++tick) {
    const auto packets = simulation->step();
    if (!packets) return failed_at(packets.error().step, packets.error().error);
    for (const Packet& p : *packets) traffic.add(p.reason, p.updates, p.bytes.size(), p.key);
    const TraceFrame& frame = simulation->frame();
    if (const auto done = follow(*predicting, *packets, frame.tick, poses); !done) return failed_at(frame.tick, done.error());
    const auto over = [&] { return predicted.position().ticks_over() + predicted.rotation().ticks_over(); };
    const std::uint64_t before = over();
    predicted.add(frame, poses);
    if (over() > before) ++visual_violations;
    shown.add(frame, simulation->client_poses());
    shown.add_rendered(frame);
  }
  return summary(traffic, predicted, shown, static_cast<std::uint64_t>(ticks), visual_violations);
}

/// All seeds of one setting and one hand.
struct Row {
  const Setting* setting;
  double mean = 0, deviation = 0;  ///< packets/s
  Measured average;                ///< means; violations are sums, shown_worst the largest
};

/// The scene's hand, and the faster one.
using Hands = std::array<std::vector<Row>, 2>;

Row summarise(const Setting& setting, std::span<const Measured> runs) {
  Row row{.setting = &setting, .average = {}};
  const auto n = static_cast<double>(runs.size());
  for (const Measured& run : runs) {
    row.mean += run.packets_per_s / n;
    row.average.bytes_per_update += run.bytes_per_update / n;
    row.average.bit_per_s += run.bit_per_s / n;
    row.average.rule_violations += run.rule_violations;
    row.average.visual_violations += run.visual_violations;
    row.average.shown_over += run.shown_over / n;
    row.average.shown_worst = std::max(row.average.shown_worst, run.shown_worst);
    row.average.over_jnd += run.over_jnd / n;
    row.average.contact += run.contact / n;
  }
  double square = 0;
  for (const Measured& run : runs) square += (run.packets_per_s - row.mean) * (run.packets_per_s - row.mean);
  row.deviation = runs.size() > 1 ? std::sqrt(square / (n - 1)) : 0;
  row.average.packets_per_s = row.mean;
  return row;
}

/// [packets/s]
std::optional<double> rate_of_thesis(const Setting& setting) {
  std::string_view text = setting.thesis_rate;  // "42.6", "~25", "-"
  if (text.starts_with('~')) text.remove_prefix(1);
  double rate = 0;
  const bool is_known = std::from_chars(text.data(), text.data() + text.size(), rate).ec == std::errc();
  return is_known ? std::optional(rate) : std::nullopt;
}

/// Does a larger deadband cost fewer packets, with and without interpolation?
bool is_ordered(std::span<const Row> rows, std::size_t first) {
  return rows[first].mean > rows[first + 1].mean && rows[first + 1].mean > rows[first + 2].mean &&
         rows[first + 2].mean > rows[first + 3].mean;
}
/// The same with the spread of the runs in mind.
const char* order_of(std::span<const Row> rows, std::size_t first) {
  if (is_ordered(rows, first)) return "holds";
  for (std::size_t i = first; i < first + 3; ++i)
    if (rows[i].mean + rows[i].deviation < rows[i + 1].mean - rows[i + 1].deviation) return "does not hold";
  return rows[first].deviation > 0 ? "holds within the spread of the runs" : "does not hold; the spread needs more than one seed";
}
constexpr std::size_t kFirstWithout = 2, kFirstWith = 6;  // rows of S4_NI and S4_WI

std::string percent(double value) { return value == 0 ? "0 %" : fmt::format("{:.2f} %", 100 * value); }

void print_order(const char* hand, std::span<const Row> rows) {
  fmt::print("S4 > S8 > S18 > S30 without interpolation, {}: {}\n", hand, order_of(rows, kFirstWithout));
  fmt::print("S4 > S8 > S18 > S30 with interpolation, {}:    {}\n", hand, order_of(rows, kFirstWith));
}

void print_text(const Hands& hands, const ReproduceOptions& options, const sim::Scene& scene) {
  const std::vector<Row>& rows = hands[0];
  fmt::print("Thesis table 3.3 and figure 3.14: traffic control settings on {}, closed loop, {:.1f} s, seeds 1 to {}\n",
             scene.name, scene.duration, options.seeds);
  fmt::print("Chosen here: 1 virtual length unit = {} m, grip {}, the scene's hand and path.\n{}\n\n", options.length_unit,
             options.grip, about_faster_hand(options));
  Table table;
  table.heading({"setting", "packets/s", "+-", "faster hand", "+-", "thesis", "bit/s", "bytes/update", "rule broken",
                 "visual broken", "shown over", "shown worst", "felt over JND"});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row &row = rows[i], &faster = hands[1][i];
    const Measured& m = row.average;
    const bool has_rule = row.setting->rule != HapticRule::off;
    table.row({row.setting->name, fmt::format("{:.1f}", row.mean), fmt::format("{:.1f}", row.deviation),
               fmt::format("{:.1f}", faster.mean), fmt::format("{:.1f}", faster.deviation), row.setting->thesis_rate,
               fmt::format("{:.0f}", m.bit_per_s), fmt::format("{:.2f}", m.bytes_per_update),
               has_rule ? fmt::to_string(m.rule_violations + faster.average.rule_violations) : "-",
               fmt::to_string(m.visual_violations + faster.average.visual_violations), has_rule ? percent(m.shown_over) : "-",
               has_rule ? fmt::format("{:.2f}", m.shown_worst) : "-", percent(m.over_jnd)});
  }
  table.print(stdout);
  fmt::print(
      "\nrule broken     ticks in which the predicted state breaks the setting's haptic rule, all seeds and both hands together\n"
      "visual broken   ticks in which it breaks the visual thresholds, the same\n"
      "The other columns are those of the scene's hand:\n"
      "shown over      share of the ticks in contact in which the shown state, smoothed or not, breaks the haptic rule\n"
      "shown worst     largest error in these ticks, as a multiple of the permitted error\n"
      "felt over JND   share of ticks in which the error of the rendered force is perceptible (more than 10 to 22 %)\n"
      "contact         {:.0f} % of the ticks\n\n",
      100 * rows.front().average.contact);
  print_order("the scene's hand", rows);
  print_order("the faster hand", hands[1]);
}

Json json_of(const Row& row) {
  const Measured& m = row.average;
  Json entry{{"packets_per_s", row.mean},
             {"standard_deviation", row.deviation},
             {"payload_bit_per_s", m.bit_per_s},
             {"bytes_per_update", m.bytes_per_update},
             {"visual_violations", m.visual_violations},
             {"share_felt_over_jnd", m.over_jnd},
             {"share_in_contact", m.contact}};
  if (row.setting->rule != HapticRule::off) {
    entry["haptic_violations"] = m.rule_violations;
    entry["share_shown_over"] = m.shown_over;
    entry["worst_shown_ratio"] = m.shown_worst;
  }
  return entry;
}

void print_json(const Hands& hands, const ReproduceOptions& options, const sim::Scene& scene) {
  const std::vector<Row>& rows = hands[0];
  Json out{{"schema", "tactus.reproduce/3"},
           {"figure", "fig3.14"},
           {"scene", scene.name},
           {"seconds", scene.duration},
           {"seeds", options.seeds},
           {"length_unit_m", options.length_unit},
           {"grip", options.grip},
           {"faster_hand", {{"pace", options.pace}, {"tremor_m", options.tremor}}}};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Json entry{{"setting", rows[i].setting->name}, {"scene_hand", json_of(rows[i])}, {"faster_hand", json_of(hands[1][i])}};
    if (const auto rate = rate_of_thesis(*rows[i].setting))
      entry["thesis"] = {{"packets_per_s", *rate}, {"is_approximate", rows[i].setting->thesis_rate[0] == '~'}};
    out["settings"].push_back(std::move(entry));
  }
  out["ordered_without_interpolation"] = is_ordered(rows, kFirstWithout);
  out["ordered_with_interpolation"] = is_ordered(rows, kFirstWith);
  fmt::print("{}\n", text_of_json(out));
}

/// All settings but the reference, whose 1000 packets/s would flatten the rest.
Plot figure_of(const Hands& hands) {
  Plot plot{.name = "fig3.14", .program = "settings-figure-3.14", .width = 900, .height = 420};
  PlotData rates{"hands", {}}, thesis{"thesis", {}};
  std::vector<std::string> names;
  for (std::size_t i = 0; i < hands[0].size(); ++i) {
    const Row &scene = hands[0][i], &faster = hands[1][i];
    if (scene.setting->reduction == Reduction::none) continue;
    names.emplace_back(scene.setting->name);
    const auto place = static_cast<double>(names.size());
    rates.rows.push_back({place, scene.mean, scene.deviation, faster.mean, faster.deviation});
    if (const auto rate = rate_of_thesis(*scene.setting)) thesis.rows.push_back({place, *rate});
  }
  plot.set("names", names);
  plot.data = {std::move(rates), std::move(thesis)};
  return plot;
}

Outcome reproduce_settings(const ReproduceOptions& options) {
  const auto path = sim::find_scene("rotate-push-lift");
  if (!path) return refuse(path.error());
  const auto scene = sim::load_scene(*path);
  if (!scene) return refuse(scene.error());
  const sim::Grip grip = grip_of(options.grip);
  const std::array<sim::Scene, 2> scenes{*scene, with_faster_hand(*scene, options)};
  const std::size_t of_a_hand = kSettings.size() * options.seeds, jobs = scenes.size() * of_a_hand;
  const auto setting_of = [&](std::size_t i) -> const Setting& { return kSettings[i % of_a_hand / options.seeds]; };
  std::optional<std::vector<Measured>> results;
  {
    Progress progress("reproduce", jobs, options.common.progress());
    const auto job = [&](std::size_t i) {
      const Setting& setting = setting_of(i);
      return measure(scenes[i / of_a_hand], setting, triggers_of(setting, options.length_unit), grip, 1 + i % options.seeds);
    };
    results = run_in_workers<Measured>(jobs, job, [&](std::size_t done) { progress.update(done); });
  }
  if (!results) return refuse("a worker process ended early", "Check whether memory ran out.");
  Hands hands;
  for (std::size_t i = 0; i < jobs; ++i) {
    const Measured& m = (*results)[i];
    if (m.failure.failed) return refuse(setting_of(i).name, place_of_tick(m.failure.tick), m.failure.error());
    if (i % options.seeds == 0)
      hands[i / of_a_hand].push_back(summarise(setting_of(i), std::span(*results).subspan(i, options.seeds)));
  }
  options.common.json ? print_json(hands, options, *scene) : print_text(hands, options, *scene);
  return write_figure(options, figure_of(hands), {});
}

Outcome run(const ReproduceOptions& options) {
  if (options.figure == "all") return reproduce_all(options);
  const bool has_delay = options.figure.starts_with("fig4.");
  if (!is_drawn(options.figure) && !options.directory.empty())
    return refuse_arguments("--output: " + options.figure + " is a table, and not drawn", "Leave out --output.");
  if (is_limit_figure(options.figure)) return reproduce_limits(options);
  if (is_touch_figure(options.figure)) return reproduce_touch(options);
  if (has_delay) return reproduce_delay(options);
  if (options.figure == "fig3.3") return reproduce_traffic(options);
  if (options.figure == "fig3.8") return reproduce_ways(options);
  if (options.figure == "fig3.11") return reproduce_interpolation(options);
  if (options.figure == "fig3.6") return reproduce_architectures(options);
  if (options.figure == "fig3.10") return reproduce_adjusted(options);
  return reproduce_settings(options);
}

}  // namespace

bool is_drawn(std::string_view figure) { return figure != "fig3.6" && figure != "fig3.10"; }

sim::Scene with_faster_hand(sim::Scene scene, const ReproduceOptions& options) {
  sim::set_pace(scene, options.pace);
  sim::set_tremor(scene, options.tremor);
  return scene;
}

std::string about_faster_hand(const ReproduceOptions& options) {
  return fmt::format(
      "The faster hand takes {:g} of the time for each movement and has a tremor of {:g} mm. The usual {:g} and {:g} mm are a "
      "fit to three\n"
      "rates of figure 3.14, no evidence of how the thesis's people moved.",
      options.pace, 1e3 * options.tremor, ReproduceOptions{}.pace, 1e3 * ReproduceOptions{}.tremor);
}

void setup_reproduce(Command& app, Action& action) {
  auto options = std::make_shared<ReproduceOptions>();
  Command& command = app.add_command("reproduce", "Run an experiment of the thesis and compare the figures");
  command
      .add_option(
          "FIGURE", options->figure,
          "all: every figure in one report. Traffic: fig3.3, why updates are sent; fig3.6, states or forces; fig3.8, ways of "
          "interpolation; fig3.10, "
          "adjusted deadbands; fig3.11, interpolation; fig3.14, also called table3.3, settings. Delay: fig4.1 and fig4.2, "
          "what it does; fig4.6, at constant speed; fig4.7, impedance of a rigid object; fig4.8, a cube; fig4.10 to "
          "fig4.12, two users at a block; fig4.13a, a delay that varies; fig4.16 and fig4.17, limits of stability; fig4.18, "
          "two users press; fig4.20 and fig4.22, impedance of a deformable object; fig4.21, a press; fig4.23, stiffness of "
          "a membrane; fig4.24, two users, with compensation; fig4.25, a one-dimensional object; fig4.27, a membrane")
      ->required()
      ->one_of({"all",     "fig3.3",  "fig3.6",  "fig3.8",  "fig3.10", "fig3.11", "fig3.14",  "fig4.1",  "fig4.2",
                "fig4.6",  "fig4.7",  "fig4.8",  "fig4.10", "fig4.11", "fig4.12", "fig4.13a", "fig4.16", "fig4.17",
                "fig4.18", "fig4.20", "fig4.21", "fig4.22", "fig4.23", "fig4.24", "fig4.25",  "fig4.27", "table3.3"})
      ->type_name("");
  command.add_option("--seeds", options->seeds, "Runs per setting")->show_default()->check(whole_number(1, 1000))->type_name("N");
  add_quantity(command, "--length-unit", options->length_unit, Dimension::length,
               "Metres per virtual length unit of the thesis [0.05m]")
      ->check(above_zero(Dimension::length));
  add_grip(command, options->grip, options->grip);
  add_pace(command, options->pace, "0.5; of the faster hand of fig3.10 and fig3.14");
  add_tremor(command, options->tremor, "0.4mm; of the same");
  command.add_option("-o,--output", options->directory, "Folder for figure and table; fig3.6 and fig3.10 are tables only")
      ->type_name("DIR");
  add_output_options(command, options->common);
  command.footer(
      "Examples:\n"
      "  tactus reproduce fig3.14 --seeds 5\n"
      "  tactus reproduce fig3.3 -o figures\n"
      "  tactus reproduce fig4.24 -o figures\n"
      "  tactus reproduce all -o thesis");
  on_chosen<ReproduceOptions>(command, action, options, run);
}

}  // namespace tactus::cli
