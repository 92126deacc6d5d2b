// SPDX-License-Identifier: Apache-2.0
/// Figures of thesis chapter 4 beside those of forces: the delay that varies (4.13a), limits of stability (4.16, 4.17) and the stiffness
/// of a surface (4.23).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include <tactus/sim/deformable/stiffness_map.h>
#include <tactus/sim/link/link.h>
#include "cli/laboratory/delay_figure.h"
#include "cli/laboratory/stability_plots.h"
#include "cli/laboratory/stiffness_map.h"
#include "lab/study/stability.h"

namespace tactus::cli {
namespace {

namespace study = sim::study;

/// Round trips [ms] of datagrams sent each 10 ms for an hour and answered at once.
tactus::Result<std::vector<double>> round_trips(const sim::LinkOptions& way) {
  constexpr sim::Microseconds kStep = 10'000, kNever = INT64_MAX;
  constexpr std::uint32_t kSent = 360'000;
  sim::LinkOptions back = way;
  back.seed = way.seed + 1;
  TACTUS_TRY(auto up, sim::Link::create(way));
  TACTUS_TRY(auto down, sim::Link::create(back));
  std::vector<double> out;
  for (std::uint32_t sent = 0; out.size() < kSent;) {
    const sim::Microseconds send = sent < kSent ? kStep * sent : kNever;
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

/// Density of a gamma distribution of this shape and scale [ms], moved by `from`.
double gamma_density(double x, double shape, double scale, double from) {
  const double t = (x - from) / scale;
  return t > 0 ? std::exp((shape - 1) * std::log(t) - t - std::lgamma(shape)) / scale : 0;
}

tl::expected<DelayFigure, Failure> varying_delay() {
  const sim::LinkOptions way = varying_network();
  auto found = round_trips(way);
  if (!found) return refuse("fig4.13a", found.error());
  std::vector<double>& times = *found;
  const double fixed = 2e-3 * static_cast<double>(way.delay), mean = 2e-3 * static_cast<double>(way.gamma_mean);
  const double each = static_cast<double>(way.gamma_mean) / static_cast<double>(way.gamma_deviation);
  const double shape = 2 * each * each, scale = mean / shape;  // of the sum of two
  DelayFigure out{.figure = "fig4.13a", .title = "round trips over the network with varying delay"};
  out.columns = {"here", "gamma"};
  double sum = 0, square = 0;
  for (const double t : times) sum += t;
  const double middle = sum / static_cast<double>(times.size());
  for (const double t : times) square += (t - middle) * (t - middle);
  out.compare("mean", "ms", middle, fixed + mean);
  out.compare("standard deviation", "ms", std::sqrt(square / static_cast<double>(times.size())), scale * std::sqrt(shape));
  out.compare("shortest", "ms", *std::ranges::min_element(times), fixed);

  constexpr double kBin = 2, kFirst = 50, kLast = 130;  // [ms]
  std::vector<double> counts(static_cast<std::size_t>((kLast - kFirst) / kBin));
  for (const double t : times)
    if (t >= kFirst && t < kLast) counts[static_cast<std::size_t>((t - kFirst) / kBin)] += 1;
  out.plot = {.name = "fig4.13a", .program = "delay-histogram", .width = 900, .height = 440};
  PlotData data{"histogram", {}};
  out.table = "round_trip_ms,share_per_ms,gamma_per_ms\n";
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double at = kFirst + kBin * (static_cast<double>(i) + 0.5);
    data.rows.push_back({at, counts[i] / kBin / static_cast<double>(times.size()), gamma_density(at, shape, scale, fixed)});
    out.table += fmt::format("{},{:.6g},{:.6g}\n", at, data.rows.back()[1], data.rows.back()[2]);
  }
  out.plot.set("bin", kBin);
  out.plot.data = {std::move(data)};
  return out;
}

/// Of a study of stability, what one figure shows.
tl::expected<DelayFigure, Failure> of_study(const char* figure, const char* title, const study::Study& made, const char* plot,
                                            const char* subjects, const char* unit) {
  DelayFigure out{.figure = figure, .title = title};
  out.columns = {"here"};
  for (const study::Row& row : made.rows) {
    if (!row.subject.starts_with(subjects) || !row.measured) continue;
    std::string name = row.subject;
    for (const study::Parameter& p : row.parameters) name += fmt::format(", {} {:g} {}", p.name, p.value, p.unit);
    out.quantities.push_back({fmt::format("{}: {}, {}", name, study::name(row.verdict), row.quantity), unit, {*row.measured}});
  }
  for (StabilityPlot& found : stability_plots({&made, 1}))
    if (found.plot.name == plot) out.plot = std::move(found.plot);
  out.plot.name = figure;
  out.table = "series,x,y\n";
  for (const PlotData& data : out.plot.data)
    for (const auto& row : data.rows)
      if (row.size() >= 2) out.table += fmt::format("{},{:.6g},{:.6g}\n", data.name, row[0], row[1]);
  return out;
}

Outcome stiffness(const ReproduceOptions& options) {
  const auto path = sim::find_scene("membrane");
  if (!path) return refuse(path.error());
  const auto scene = sim::load_scene(*path);
  if (!scene) return refuse(scene.error());
  const auto map = sim::stiffness_map(scene->deformables.front());
  if (!map) return refuse(*path, map.error());
  std::vector<double> left, right;
  for (std::size_t v = 0; v < map->stiffness.size(); ++v)
    if (std::isfinite(map->stiffness[v])) (map->surface.vertices[v].x < 0 ? left : right).push_back(map->stiffness[v]);
  const auto median = [](std::vector<double>& v) {
    std::ranges::nth_element(v, v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2));
    return v[v.size() / 2];
  };
  DelayFigure out{.figure = "fig4.23", .title = "stiffness of the membrane at each vertex of its surface"};
  out.columns = {"here"};
  out.quantities.push_back({"median of the half at x < 0", "N/m", {median(left)}});
  out.quantities.push_back({"median of the half at x > 0", "N/m", {median(right)}});
  out.quantities.push_back({"softest", "N/m", {std::min(*std::ranges::min_element(left), *std::ranges::min_element(right))}});
  tell(options, out);
  if (options.directory.empty()) return {};
  TACTUS_CHECK(make_folder(options.directory));
  TACTUS_TRY(const auto drawn,
             write_stiffness_map(*scene, *path, options.directory + "/fig4.23.csv", options.common.existing(), {}));
  if (drawn == Drawn::no) fmt::print(stderr, "note: {}\n", kNoGnuplot);
  return {};
}

}  // namespace

sim::LinkOptions varying_network() {
  return {.delay = 25'000, .gamma_mean = 12'000, .gamma_deviation = 8'000, .gamma_piece = 500'000};
}

bool is_limit_figure(const std::string& figure) {
  return figure == "fig4.13a" || figure == "fig4.16" || figure == "fig4.17" || figure == "fig4.23";
}

Outcome reproduce_limits(const ReproduceOptions& options) {
  if (options.figure == "fig4.23") return stiffness(options);
  const auto quiet = [](const std::string&, std::uint64_t, std::uint64_t) {};
  if (options.figure == "fig4.13a") {
    TACTUS_TRY(const DelayFigure made, varying_delay());
    return finish(options, made);
  }
  const bool is_jury = options.figure == "fig4.16";
  const study::Study made =
      is_jury ? study::study_jury(study::Extent::brief, quiet) : study::study_client(study::Extent::brief, quiet);
  TACTUS_TRY(const DelayFigure figure,
             is_jury ? of_study("fig4.16", "two users step onto an object near the critical stiffness of eq. 4.38, 700 N/m", made,
                                "jury-figure-4.16", "figure 4.16", "1")
                     : of_study("fig4.17", "grip, damping and object stiffness: force and energy at a client, 100 ms", made,
                                "client-figure-4.17", "(", "mJ"));
  return finish(options, figure);
}

}  // namespace tactus::cli
