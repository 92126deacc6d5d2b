// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/laboratory/precision_report.h"

namespace tactus::cli {
namespace {

using sim::study::Errors;
using sim::study::PrecisionPoint;

/// One colour per method, one dash and mark per variant of it.
struct Style {
  int colour = 1, dash = 1, mark = 7;
};

Style style_of(const sim::study::PrecisionMethod& method, int variant) {
  constexpr int kMarks[] = {7, 4, 9};  // gnuplot's disc, open square, triangle
  if (method.chosen) return {8, 1, 5};
  const int colour = method.options.method == sim::Method::velocity_verlet ? 7 : static_cast<int>(method.options.method);
  return {colour, variant + 1, kMarks[variant % 3]};
}

std::string frame(const std::string& title, const std::string& x_label) {
  return fmt::format(
      "set logscale xy\nset format x '10^{{%L}}'\nset format y '10^{{%L}}'\nset mxtics 1\nset mytics 1\n"
      "set title {} noenhanced\nset xlabel {} noenhanced\nset ylabel 'seconds of one core per simulated second'\n"
      "set yrange [*:3<*]\nset key outside right top Left reverse samplen 2.5\n",
      gnuplot_text(title), gnuplot_text(x_label));
}

void append(std::string& list, const std::string& item) { list += (list.empty() ? "plot " : ", \\\n  ") + item; }

struct Quantity {
  const char* name;
  double Errors::*error;
  const char* label;
};
constexpr Quantity kQuantities[] = {
    {"displacement", &Errors::displacement, "relative error of displacements"},
    {"force", &Errors::force, "relative error of the force at the probe"},
    {"energy", &Errors::energy, "relative error of energy"},
    {"weight", &Errors::weight, "relative error of displacements under a weight that is there at once"},
};

Plot time_plot(const TimeStudy& time, const Quantity& quantity) {
  Plot plot;
  plot.name = time.scene.name + "-" + quantity.name;
  plot.width = 1100;
  plot.height = 680;
  std::string lines;
  PlotData rings{"rings", {}};
  int variant = 0;
  const sim::study::PrecisionMethod* before = nullptr;
  for (std::size_t m = 0; m < time.methods.size(); ++m) {
    const sim::study::PrecisionMethod& method = time.methods[m];
    variant = before != nullptr && !before->chosen && before->options.method == method.options.method ? variant + 1 : 0;
    before = &method;
    PlotData data{fmt::format("m{}", m), {}};
    for (const PrecisionPoint& p : time.points) {
      const double error = p.errors.*quantity.error;
      if (p.method == method.name && is_usable(error)) data.rows.push_back({error, p.seconds_per_second, 1e3 * p.step});
    }
    if (data.rows.empty()) continue;
    const Style style = style_of(method, variant);
    append(
        lines,
        fmt::format("${0} using 1:2 with linespoints linetype {1} dashtype {2} pointtype {3} pointsize 0.8 title {4} noenhanced",
                    data.name, style.colour, style.dash, style.mark, gnuplot_text(method.name)));
    // Linear elasticity is off by the same whatever the step.
    if (method.elasticity == sim::Elasticity::corotated) {
      append(lines, fmt::format("${0} using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor "
                                "linetype {1} notitle",
                                data.name, style.colour));
    }
    for (const auto& row : data.rows)
      if (std::abs(row[2] - 1) < 1e-6) rings.rows.push_back({row[0], row[1]});
    plot.data.push_back(std::move(data));
  }
  if (!rings.rows.empty()) {
    append(lines, "$rings using 1:2 with points pointtype 6 pointsize 1.8 linewidth 1.5 linecolor rgb '#222222' notitle");
    plot.data.push_back(std::move(rings));
  }
  append(lines, "1 with lines linewidth 1.5 linecolor rgb '#222222' title 'real time; at 1 kHz, 1 ms per step'");
  plot.script = frame(time.scene.title + "; marks: h in ms, ringed: 1 ms",
                      fmt::format("{} (the reference is off by {:.1e})", quantity.label, time.reference.errors.*quantity.error));
  plot.script += lines + '\n';
  return plot;
}

Plot space_plot(const std::string& scene, const std::vector<const SpaceStudy*>& studies) {
  Plot plot;
  plot.name = "space-" + scene;
  plot.width = 1100;
  std::string lines;
  int colour = 0;
  for (const SpaceStudy* study : studies) {
    PlotData data{fmt::format("s{}", plot.data.size()), {}};
    for (std::size_t i = 0; i < study->points.size(); ++i)
      data.rows.push_back({static_cast<double>(study->points[i].tets), study->errors.at_rest_error[i],
                           study->errors.quadratic_error[i], study->errors.transient_error[i]});
    const double poisson = study->points.front().poisson;
    append(lines,
           fmt::format("${} using 1:2 with linespoints linetype {} title 'linear, nu {:.3g}'", data.name, ++colour, poisson));
    append(lines, fmt::format("${} using 1:3 with points linetype {} pointtype 4 pointsize 1.2 title 'quadratic, nu {:.3g}'",
                              data.name, colour, poisson));
    if (std::isfinite(study->errors.transient_error.front())) {
      append(lines,
             fmt::format("${} using 1:4 with linespoints linetype {} dashtype 2 pointtype 9 title 'linear in time, nu {:.3g}, "
                         "against the finest'",
                         data.name, colour, poisson));
    }
    plot.data.push_back(std::move(data));
  }
  plot.script = fmt::format(
      "set logscale xy\nset format x '10^{{%L}}'\nset title {} noenhanced\n"
      "set xlabel 'tetrahedra'\nset ylabel 'relative error of the deflection'\nset key outside right top Left reverse\n",
      gnuplot_text(scene + ": deflection of the loaded patch"));
  plot.script += lines + '\n';
  return plot;
}

}  // namespace

std::vector<Plot> precision_plots(const PrecisionReport& report) {
  std::vector<Plot> plots;
  for (const TimeStudy& time : report.times)
    for (const Quantity& quantity : kQuantities) plots.push_back(time_plot(time, quantity));
  std::vector<std::string> drawn;
  for (const SpaceStudy& space : report.spaces) {
    if (std::find(drawn.begin(), drawn.end(), space.scene) != drawn.end()) continue;
    drawn.push_back(space.scene);
    std::vector<const SpaceStudy*> same;
    for (const SpaceStudy& other : report.spaces)
      if (other.scene == space.scene) same.push_back(&other);
    plots.push_back(space_plot(space.scene, same));
  }
  return plots;
}

}  // namespace tactus::cli
