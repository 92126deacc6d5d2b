// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <tactus/sim/link/session_network.h>
#include <tactus/sim/simulation.h>
#include <tactus/thesis/if_built.h>
#include <tactus/trace/trace_file.h>
#ifdef TACTUS_HAS_NET
#include "cli/commands/session_capture.h"
#endif
#include "cli/commands/input.h"
#include "cli/commands/scene_run.h"
#include "cli/commands/sim_check.h"
#include "cli/commands/sim_run.h"
#include "cli/commands/stiffness_map.h"
#include "cli/figure/time_figure.h"
#include "cli/live/ticker.h"
#include "cli/options/option_needs.h"
#include "cli/options/options_link.h"
#include "cli/report/report.h"
#include "cli/report/sim_report.h"
#include "cli/report/table.h"

namespace tactus::cli {
namespace {

constexpr double kMostTicks = 0xffffffff;     // of a stream: spec/20-scene.md
constexpr std::uint32_t kEstimateEvery = 19;  // deformations between looks at their error: no beat with what repeats

Report make_report(const SimOptions& options, const TraceInfo& info) {
  Report report{.command = "sim", .files = {{"scene", options.scene}, {"trace", options.output}}};
  if (!options.stream.empty()) report.files.emplace_back("stream", options.stream);
  report.describe(info);
  report.timings = {{"simulate"}};
  if (options.replay.empty()) report.seed = options.seed;
  else report.files.emplace_back("replay", options.replay);
  if (!options.has_channel()) return report;
  report.fidelity.emplace(info, options.triggers.triggers());
  if (options.has_network()) return report;
  if (report.moving > 0 || info.meshes.empty()) report.traffic.emplace();
  add_meshes(info, options.meshes, options.triggers, report);
  for (MeshReport& mesh : report.meshes) mesh.guaranteed = options.meshes.is_main();
  const bool is_smoothed = report.moving > 0 && options.meshes.coding(options.triggers).rigid == RigidProfile::main;
  report.client = display_of_client(options.replica.interpolation, is_smoothed);
  // A client that smooths what it shows leaves the bounds that the encoder keeps.
  if (report.client != ClientDisplay::interpolated)
    report.bounds_from = options.triggers.any_given() || options.meshes.any_given() ? "options" : "defaults";
  return report;
}

tl::expected<sim::Scene, Failure> read_scene(const SimOptions& options) {
  const auto path = sim::find_scene(options.scene);
  if (!path) return refuse(path.error());
  auto scene = sim::load_scene(*path);
  if (!scene) return refuse(scene.error());
  for (sim::SceneDeformable& object : scene->deformables) {
    if (!options.method.empty()) object.method = options.method;
    if (!options.solver.empty()) object.solver = options.solver;
    if (options.rate > 0) object.rate = options.rate;
  }
  for (sim::SceneMsd& object : scene->msds)
    if (options.rate > 0) object.rate = options.rate;
  options.hands.apply(*scene);
  compensate(*scene, options.compensation);
  return *scene;
}

void describe_deformables(const sim::Simulation& simulation, Report& report) {
  if (simulation.deformables() == nullptr) return;
  for (const sim::DeformableInfo& object : simulation.deformables()->info())
    report.deformables.push_back({.name = object.name,
                                  .method = object.method,
                                  .reason = object.reason,
                                  .vertices = object.vertices,
                                  .step = object.step,
                                  .h_omega = object.step * object.largest_frequency});
  report.timings.push_back({"deform"});
}

void report_errors(const sim::Simulation& simulation, Report& report) {
  if (simulation.deformables() == nullptr) return;
  for (std::size_t i = 0; i < report.deformables.size(); ++i) {
    const auto error = simulation.deformables()->error(i);
    if (!error || error->samples == 0) continue;
    report.deformables[i].samples = static_cast<std::uint64_t>(error->samples);
    report.deformables[i].error_of_motion = error->of_motion;
    report.deformables[i].error_most = error->most_of_motion;
    report.deformables[i].energy_gained = error->energy;
  }
}

std::set<Subject> subjects_of_scene(const sim::Scene& scene) {
  std::set<Subject> held;
  const bool moves =
      std::any_of(scene.objects.begin(), scene.objects.end(), [](const sim::SceneObject& o) { return o.dof != Dof::none; });
  if (moves || !scene.msds.empty() || scene.deformables.empty()) held.insert(Subject::rigid);
  if (!scene.users.empty()) held.insert(Subject::user);
  if (!scene.deformables.empty()) held.insert({Subject::mesh, Subject::deformable, Subject::deformed});
  if (!scene.deformables.empty() && !scene.users.empty()) held.insert(Subject::touched_mesh);
  if (!scene.msds.empty()) held.insert(Subject::deformed);
  return held;
}

Outcome draw_stiffness(const sim::Scene& scene, const SimOptions& options, StepTimes& times) {
  if (options.stiffness_map.empty() || scene.deformables.empty()) return {};
  return times.measure([&] {
    return write_stiffness_map(scene, options.scene, options.stiffness_map, options.common.existing(),
                               {options.scene, options.output, options.stream, options.replay, options.pcap});
  });
}

/// All was closed in order, but not all was done.
tl::unexpected<Failure> stopped(int signal, const Report& report, const SimOptions& options) {
  Failure failure{fmt::format("stopped at {:.2f} s, {} is complete up to there", report.seconds(),
                              options.output == "-" ? "the trace" : options.output),
                  ""};
  failure.cause = Failure::Cause::stopped;
  failure.signal = signal;
  return tl::unexpected(std::move(failure));
}

/// What `--link`, `--uplink` and `--playout` say.
tl::expected<sim::NetworkOptions, Failure> network_of(const SimOptions& options, const sim::Scene& scene) {
  if (!options.stream.empty())
    return refuse_arguments("--stream: over a network each user gets packets of their own", "Leave out --stream, or --link.");
  if (scene.users.empty())
    return refuse_arguments("--link: nobody is in this scene, so there is no session", "Give a scene with users.");
  sim::NetworkOptions out;
  out.downlink = options.link.value_or(sim::LinkOptions{});
  out.uplink = options.uplink.value_or(out.downlink);
  out.playout.fixed = playout_of(options.playout);
  return out;
}

/// The network of a simulation, once that is made, and the capture of its datagrams.
struct Networked {
  sim::SessionNetwork* network = nullptr;
#ifdef TACTUS_HAS_NET
  std::unique_ptr<SessionCapture> capture;
#endif
};

/// in   networked  outlives the making of the simulation
Outcome add_network(const SimOptions& options, const sim::Scene& scene, Networked& networked, sim::ChannelOptions& channel) {
  TACTUS_TRY(auto of_network, network_of(options, scene));
#ifdef TACTUS_HAS_NET
  if (!options.pcap.empty()) {
    TACTUS_TRY(networked.capture, SessionCapture::create(options.pcap, options.common.existing(),
                                                         {options.output, options.scene, options.replay, options.stiffness_map},
                                                         SessionCapture::End::client));
    of_network.observer = networked.capture->observer();
  }
#endif
  channel.network = [&networked, of_network](SharedScene declared, std::size_t users,
                                             const SenderOptions& sender) -> Result<std::unique_ptr<sim::Network>> {
    TACTUS_TRY(auto made, sim::SessionNetwork::create(std::move(declared), users, sender, of_network));
    networked.network = made.get();
    return made;
  };
  return {};
}

/// The sessions end, and the capture is whole.
Outcome keep_capture([[maybe_unused]] const Networked& networked) {
#ifdef TACTUS_HAS_NET
  if (!networked.capture) return {};
  networked.network->leave();
  return networked.capture->keep();
#else
  return {};
#endif
}

/// in   networked  outlives the simulation
tl::expected<sim::SimulationOptions, Failure> settings_of(const SimOptions& options, const sim::Scene& scene,
                                                          Networked& networked) {
  sim::SimulationOptions out{.seed = options.seed,
                             .grip = options.hands.grip(),
                             .channel = {},
                             .mesh_noise = options.mesh_noise,
                             .estimate_every = kEstimateEvery};
  if (options.has_channel())
    out.channel = sim::ChannelOptions{options.meshes.sender(options.triggers),
                                      options.replica,
                                      options.meshes.coding(options.triggers),
                                      {.thesis = thesis_if_built()},
                                      options.client_model_scale};
  if (!options.has_network()) return out;
  out.channel->timed = true;
  TACTUS_CHECK(add_network(options, scene, networked, *out.channel));
  return out;
}

/// A finer run of the same, which writes nothing.
struct FinerRun {
  SimOptions options;
  sim::Scene scene;
  Networked networked{};
  std::optional<sim::Simulation> simulation{};
  std::optional<TraceReader> recording{};
  TraceFrame recorded{};
  CheckedTick now{};
  std::int64_t left;  // ticks

  Outcome begin(int parts) {
    options.pcap.clear();
    TACTUS_TRY(auto settings, settings_of(options, scene, networked));
    settings.parts = parts;
    settings.estimate_every = 0;
    auto made = sim::Simulation::create(scene, settings);
    if (!made) return refuse(options.scene, made.error());
    simulation.emplace(std::move(*made));
    if (options.replay.empty()) return {};
    TACTUS_TRY(auto reader, open_replay(options.replay, Visibility::hidden));
    recording.emplace(std::move(reader));
    return {};
  }

  const CheckedTick* step() {
    if (left-- == 0) return nullptr;
    if (recording) {
      const auto more = next_frame(*recording, recorded, options.replay);
      if (!more || !*more) return nullptr;
    }
    now.begin(*simulation);
    const auto stepped = recording ? simulation->step(recorded_devices(*recording, recorded)) : simulation->step();
    if (!stepped) fmt::print(stderr, "tactus: --check: {}: {}\n", options.scene, printable(to_string(stepped.error())));
    if (!stepped) return nullptr;
    now.end(simulation->frame());
    return &now;
  }
};

Outcome start_checks(const SimOptions& options, const sim::Scene& scene, const TraceInfo& info, std::int64_t ticks, SimRun& run) {
  if (!options.check) return {};
  const auto add = [&](const char* against, int parts, std::uint32_t rate) -> Outcome {
    TACTUS_TRY(auto check, SimCheck::start(info, against, [&]() -> SimCheck::Step {
                 auto finer = std::make_shared<FinerRun>(FinerRun{.options = options, .scene = scene, .left = ticks});
                 if (rate > 0)
                   for (sim::SceneDeformable& object : finer->scene.deformables) object.rate = rate;
                 if (const auto begun = finer->begin(parts); !begun) return {};
                 return [finer] { return finer->step(); };
               }));
    run.checks.push_back(std::move(check));
    return {};
  };
  TACTUS_CHECK(add("half the step", 2, 0));
  const bool is_rare = std::ranges::any_of(scene.deformables, [](const sim::SceneDeformable& object) { return object.rate > 1; });
  return is_rare ? add("a shape in each tick", 1, 1) : Outcome();
}

/// What needs no scene.
Outcome check_options(const SimOptions& options) {
  TACTUS_CHECK(check_no_terminal(options.output));
  if (options.duration >= 0 && options.duration < 0.5 / sim::kTickRate)
    return refuse_arguments("--duration: shorter than a tick", "Give at least 1ms.");
  if (options.duration * sim::kTickRate > kMostTicks)
    return refuse_arguments("--duration: more ticks than can be numbered",
                            fmt::format("Give at most {:.0f}s.", std::floor(kMostTicks / sim::kTickRate)));
  if (!options.pcap.empty() && !options.has_network())
    return refuse_arguments("--pcap: without a network there are no datagrams", "Give a network with --link.");
  for (const auto& [name, why] : {std::pair{"--playout", "nothing is late"},
                                  {"--tune client_model_scale", "there are no clients whose models it could scale"}})
    if (!options.has_network() && options.common.command->find(name)->count() > 0)
      return refuse_arguments(fmt::format("{}: without a network {}", name, why), "Give --link or --uplink, or leave it out.");
  return {};
}

Outcome run_sim(const SimOptions& options) {
  TACTUS_CHECK(check_options(options));
  TACTUS_TRY(const auto scene, read_scene(options));
  note_idle_options(*options.common.command, subjects_of_scene(scene), "scene");
  Networked networked;
  TACTUS_TRY(const auto settings, settings_of(options, scene, networked));
  if (options.has_network()) {
    TACTUS_TRY(const auto network, network_of(options, scene));
    warn_of_two(network, scene);
  }
  auto simulation = sim::Simulation::create(scene, settings);
  if (!simulation) return refuse(options.scene, simulation.error());
  std::optional<TraceReader> recording;
  if (!options.replay.empty()) {
    TACTUS_TRY(auto reader, open_replay(options.replay, options.common.progress()));
    recording.emplace(std::move(reader));
  }
  TACTUS_CHECK(
      check_plot_option(options.plot, options.common, {options.output, options.stream, options.stiffness_map, options.pcap}));
  TACTUS_TRY(auto output,
             OutputFile::create_growing(options.output, options.common.existing(),
                                        {options.stream, options.stiffness_map, options.scene, options.replay, options.pcap}));
  std::optional<StreamOutput> stream;
  if (!options.stream.empty()) {
    TACTUS_TRY(auto opened, open_stream(options, *simulation->stream_scene()));
    stream.emplace(std::move(opened));
  }
  Timing map{"stiffness_map"};
  TACTUS_CHECK(draw_stiffness(scene, options, map.times));
  const TraceInfo info = simulation->info();
  auto trace = TraceWriter::create(output.working_path(), info);
  if (!trace) return refuse(options.output, trace.error());
  Report report = make_report(options, info);
  describe_deformables(*simulation, report);
  if (options.has_channel() && !options.has_network() && simulation->stream_scene()->loads) report.loads.emplace();
  SimRun session{std::move(*simulation),
                 std::move(output),
                 std::move(*trace),
                 std::move(stream),
                 std::move(recording),
                 {},
                 {},
                 {},
                 {},
                 {},
                 {},
                 {},
                 {}};
  if (!options.plot.empty()) session.figure.emplace(info);
  if (networked.network != nullptr) {
    session.judge.emplace(info, scene, options.triggers, options.meshes);
    session.network = networked.network;
  }
  const auto ticks = options.duration < 0 ? session.simulation.ticks()
                                          : static_cast<std::int64_t>(std::llround(options.duration * sim::kTickRate));
  TACTUS_CHECK(start_checks(options, scene, info, ticks, session));
  if (auto done = simulate(session, ticks, options, report); !done) {
    if (report.ticks.count() == 0) session.output.discard();
    return done;
  }
  if (const SharedScene declared = session.simulation.stream_scene())
    for (const std::string& line : session.held.lines(*declared)) report.warnings.push_back(line);
  report_touches(scene, session.simulation, options.has_network(), report);
  report_rigid(scene, session.simulation.rigid_errors(), report);
  if (session.judge) report.networks = session.judge->finish(*session.network);
  else if (options.has_channel()) report.stream = stream_size(session);
  TACTUS_CHECK(keep_capture(networked));
  report_errors(session.simulation, report);
  for (SimCheck& check : session.checks) report.checks.push_back(check.finish());
  report.timings.push_back(std::move(map));
  print(report, options.common, beside(options.output));
  if (session.figure) TACTUS_CHECK(draw(options.plot, Figure{options.scene, session.figure->panels()}, options.common));
  if (const int signal = StopOnSignal::caught(); signal != 0) return stopped(signal, report, options);
  TACTUS_CHECK(check_contacts(report, options.scene));
  return report.bounds_from.empty() ? Outcome() : verdict(report, options.output);
}

}  // namespace

void setup_sim(Command& app, Action& action) {
  auto options = std::make_shared<SimOptions>();
  Command& command = app.add_command("sim", "Simulate a touch and record a trace");
  command
      .add_option("SCENE", options->scene,
                  "push-1dof, rotate-6dof, rotate-push-lift, membrane, membrane-light, membrane-large, membrane-small, slab, "
                  "msd-1d, bracket-and-pad, push-cube, jenga-together, jenga-press, jenga-against, or a TOML file")
      ->type_name("")
      ->required();
  command.add_option("-o,--output", options->output, "Trace to write (MCAP), - is standard output")
      ->required()
      ->type_name("FILE");
  command.add_option("--seed", options->seed, "Seed of the random number generator")
      ->check(whole_number(0, UINT64_MAX))
      ->show_default()
      ->type_name("N");
  add_quantity(command, "--duration", options->duration, Dimension::time, "Length [the scene's]");
  add_quantity(command, key("deformable_noise"), options->mesh_noise, Dimension::length,
               "White noise added to recorded and sent shapes, RMS per axis [0]");
  options->hands.add_to(command);
  command.add_option("--replay", options->replay, "Replay the device samples of this trace instead of virtual hands")
      ->type_name("TRACE");
  command
      .add_option("--method", options->method,
                  "Time integration of deformable objects: auto, velocity-verlet, backward-euler, newmark, tr-bdf2 or projective "
                  "[the scene's]")
      ->one_of({"auto", "velocity-verlet", "backward-euler", "newmark", "tr-bdf2", "projective"})
      ->type_name("NAME");
  command
      .add_option(key("solver"), options->solver,
                  "Linear solver of implicit methods: auto, cg, cholesky or prefactored [the scene's]")
      ->one_of({"auto", "cg", "cholesky", "prefactored"})
      ->type_name("NAME");
  command.add_option("--rate", options->rate, "Ticks between deformation steps, 1 to 1000 [the scene's]")
      ->check(whole_number(1, 1000))
      ->type_name("N");
  command
      .add_option("--stiffness-map", options->stiffness_map,
                  "Also write the local stiffness of deformable objects (CSV, and a figure beside it)")
      ->type_name("FILE");
  command.add_flag(
      "--check", options->check,
      "Simulate the same again beside it with half the step, and with a shape in each tick, and report the difference "
      "in motion, shapes, forces, energies and the work of hands [costs two to four times the time]");
  command.add_flag("--codec", options->codec,
                   "Close the loop through encoder, decoder and replica; --stream, --link, --interpolate and every option and "
                   "key of the bounds and of coding imply it");
  command.add_option("--stream", options->stream, "Also write the packets")->type_name("FILE");
  Option* const interpolate = add_interpolation(command, options->replica);
  add_link(command, "--link", options->link,
           "Give each user a client of their own, joined over this network, the same there and back")
      ->excludes(interpolate);
  add_link(command, "--uplink", options->uplink, "Network from the clients to the server, if it differs");
  add_playout(command, options->playout);
  add_compensation(command, options->compensation);
  add_client_model_scale(command, options->client_model_scale);
#ifdef TACTUS_HAS_NET
  command
      .add_option("--pcap", options->pcap,
                  "With --link: also write the datagrams at the clients' network interfaces (pcap; see `tactus export pcap`)")
      ->type_name("FILE");
#endif
  add_encoder_options(command, options->triggers, options->meshes);
  add_plot_option(command, options->plot, "motion, forces and packets over time");
  add_output_options(command, options->common);
  command.footer(
      "Examples:\n"
      "  tactus sim push-1dof -o push.mcap --seed 7\n"
      "  tactus sim membrane -o membrane.mcap --rate 1\n"
      "  tactus sim rotate-push-lift -o push.mcap --stream push.tct -p 4% --profile thesis --interpolate\n"
      "  tactus sim rotate-push-lift -o far.mcap -p 4% --link delay=20ms,jitter=5ms,loss=1%\n"
      "\n" +
      std::string(link_help()));
  on_chosen<SimOptions>(command, action, options, run_sim);
}

}  // namespace tactus::cli
