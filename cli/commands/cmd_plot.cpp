// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <filesystem>

#include <tactus/base/shown.h>
#include "cli/commands/commands.h"
#include "cli/commands/motion_source.h"
#include "cli/figure/time_figure.h"
#include "cli/report/report.h"

namespace tactus::cli {
namespace {

constexpr double kMillimetres = 1e3, kKilobits = 8e-3;
constexpr std::size_t kMostObjects = 6;  // with panels and lines of their own
constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};

struct PlotOptions {
  std::string input, output;
  CommonOptions common;
};

std::array<double, 3> components(const Vec3& v) { return {v.x, v.y, v.z}; }

struct ObjectLines {
  std::size_t object;
  std::array<TimeLine, 3> position{};
  TimeLine speed{};
  bool has_speed = false;  // what a client shows has none
};

struct UserLines {
  std::array<TimeLine, 3> device{};
  TimeLine felt{}, server{};
};

/// What a figure shows of a recording.
class Lines {
 public:
  explicit Lines(const TraceInfo& info) : info_(info), users_(info.users.size()), meshes_(info.meshes.size()) {
    for (std::size_t i = 0; i < info.objects.size() && objects_.size() < kMostObjects; ++i)
      if (info.objects[i].dof != Dof::none) objects_.push_back({i});
  }

  void add(const TraceFrame& frame) {
    const double time = static_cast<double>(frame.tick) / info_.tick_rate;
    for (ObjectLines& lines : objects_) add(lines, frame.objects[lines.object], time);
    last_time_ = time;
    for (std::size_t i = 0; i < users_.size(); ++i) add(users_[i], frame.users[i], time);
    for (std::size_t i = 0; i < meshes_.size(); ++i)
      if (frame.meshes[i].updated) meshes_[i].add(time, kMillimetres * largest(frame.meshes[i].displacements));
  }

  std::vector<TimePanel> panels(const std::vector<SourcePacket>& packets) const {
    std::vector<TimePanel> out;
    TimePanel speeds{"speed [mm/s]"}, bends{"largest displacement [mm]"};
    for (const ObjectLines& lines : objects_) {
      const std::string& name = info_.objects[lines.object].name;
      out.push_back(axes_of("position of " + name + " [mm]", lines.position));
      if (lines.has_speed) speeds.lines.push_back({name, lines.speed.points()});
    }
    out.push_back(std::move(speeds));
    for (std::size_t i = 0; i < users_.size(); ++i) {
      const std::string& name = info_.users[i].name;
      out.push_back(axes_of("device of " + name + " [mm]", users_[i].device));
      TimePanel& forces = out.emplace_back(TimePanel{"force on " + name + " [N]"});
      forces.lines = {{"felt", users_[i].felt.points()}, {"of the server", users_[i].server.points()}};
    }
    for (std::size_t i = 0; i < meshes_.size(); ++i)
      if (!meshes_[i].is_empty()) bends.lines.push_back({info_.meshes[i].name, meshes_[i].points()});
    out.push_back(std::move(bends));
    add_packets(packets, out);
    return out;
  }

 private:
  void add(ObjectLines& lines, const RigidSample& sample, double time) {
    const auto parts = components(sample.pose.position);
    for (std::size_t k = 0; k < parts.size(); ++k) lines.position[k].add(time, kMillimetres * parts[k]);
    lines.has_speed = lines.has_speed || sample.velocity != Vec3{};
    lines.speed.add(time, kMillimetres * norm(sample.velocity));
  }

  void add(UserLines& lines, const UserSample& user, double time) {
    const auto parts = components(user.device.position);
    for (std::size_t k = 0; k < parts.size(); ++k) lines.device[k].add(time, kMillimetres * parts[k]);
    lines.felt.add(time, norm(user.force));
    lines.server.add(time, norm(user.server_force));
  }

  static double largest(const std::vector<float>& u) {
    double most = 0;
    for (std::size_t i = 0; i + 2 < u.size(); i += 3) most = std::max(most, norm(Vec3{u[i], u[i + 1], u[i + 2]}));
    return most;
  }

  static TimePanel axes_of(std::string label, const std::array<TimeLine, 3>& lines) {
    TimePanel out{std::move(label)};
    for (std::size_t k = 0; k < lines.size(); ++k) out.lines.push_back({kAxes[k], lines[k].points()});
    return out;
  }

  void add_packets(const std::vector<SourcePacket>& packets, std::vector<TimePanel>& out) const {
    if (packets.empty()) return;
    RateLine count, kilobits;
    for (const SourcePacket& packet : packets) {
      const double time = static_cast<double>(packet.tick) / info_.tick_rate;
      count.add(time);
      kilobits.add(time, kKilobits * static_cast<double>(packet.bytes));
    }
    const double width = width_of_rates(last_time_);
    out.push_back({"packets per second", {{"packets", count.points(width, last_time_)}}});
    out.push_back({"payload [kbit/s]", {{"payload", kilobits.points(width, last_time_)}}});
  }

  const TraceInfo& info_;
  std::vector<ObjectLines> objects_;
  std::vector<UserLines> users_;
  std::vector<TimeLine> meshes_;
  double last_time_ = 0;
};

Outcome run(const PlotOptions& options) {
  TACTUS_CHECK(check_plot_option(options.output, options.common, {options.input}));
  TACTUS_TRY(auto source, MotionSource::open(options.input));
  Report report{.command = "plot",
                .files = {{source.is_stream() ? "stream" : "trace", options.input}, {"figure", options.output}}};
  report.describe(source.info());
  Lines lines(source.info());
  Progress progress("plot", source.frame_count(), options.common.progress());
  TraceFrame frame;
  while (true) {
    TACTUS_TRY(const bool more, source.next(frame));
    if (!more) break;
    lines.add(frame);
    report.ticks.add(frame.tick);
    progress.update(report.ticks.count());
  }
  const std::string heading = std::filesystem::path(options.input).filename().string();
  TACTUS_CHECK(draw_over_time(options.output, heading, lines.panels(source.packets()), options.common));
  print(report, options.common, Destination::standard_output);
  return {};
}

}  // namespace

void setup_plot(Command& app, Action& action) {
  auto options = std::make_shared<PlotOptions>();
  Command& command = app.add_command("plot", "Draw a trace or a stream over time");
  command.add_option("FILE", options->input, "Trace (MCAP), or stream, which is decoded; - is standard input")
      ->type_name("")
      ->required();
  command.add_option("-o,--output", options->output, "Figure to draw (SVG)")
      ->required()
      ->check(svg_file())
      ->type_name("FILE.svg");
  add_output_options(command, options->common);
  command.footer(
      "Positions, speeds, forces, deformation, and of a stream its packets, each in a panel. Of a long recording a line shows "
      "the\n"
      "extremes.\n"
      "Examples:\n"
      "  tactus plot push.mcap -o push.svg\n"
      "  tactus plot push.tct -o packets.svg");
  on_chosen<PlotOptions>(command, action, options, run);
}

}  // namespace tactus::cli
