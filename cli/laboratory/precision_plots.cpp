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
  Plot plot{.name = time.scene.name + "-" + quantity.name, .program = "precision-time", .width = 1100, .height = 680};
  PlotData data{"data", {}};
  std::vector<std::string> names;
  std::vector<double> colours, dashes, marks, labels;
  int variant = 0;
  const sim::study::PrecisionMethod* before = nullptr;
  for (const sim::study::PrecisionMethod& method : time.methods) {
    variant = before != nullptr && !before->chosen && before->options.method == method.options.method ? variant + 1 : 0;
    before = &method;
    std::vector<std::vector<double>> rows;
    for (const PrecisionPoint& p : time.points) {
      const double error = p.errors.*quantity.error;
      if (p.method == method.name && is_usable(error)) rows.push_back({error, p.seconds_per_second, 1e3 * p.step});
    }
    if (rows.empty()) continue;
    if (!names.empty()) data.rows.insert(data.rows.end(), 2, {});
    data.rows.insert(data.rows.end(), rows.begin(), rows.end());
    const Style style = style_of(method, variant);
    names.push_back(method.name);
    colours.push_back(style.colour);
    dashes.push_back(style.dash);
    marks.push_back(style.mark);
    labels.push_back(method.elasticity == sim::Elasticity::corotated ? 1
                                                                     : 0);  // linear elasticity is off by the same at every step
  }
  plot.data.push_back(std::move(data));
  plot.set("heading", time.scene.title + "; marks: h in ms, ringed: 1 ms");
  plot.set("x_label", fmt::format("{} (the reference is off by {:.1e})", quantity.label, time.reference.errors.*quantity.error));
  plot.set("methods", static_cast<double>(names.size()));
  plot.set("name", names);
  plot.set("colour", colours);
  plot.set("dash", dashes);
  plot.set("mark", marks);
  plot.set("label", labels);
  return plot;
}

Plot space_plot(const std::string& scene, const std::vector<const SpaceStudy*>& studies) {
  Plot plot{.name = "space-" + scene, .program = "precision-space", .width = 1100};
  PlotData data{"data", {}};
  std::vector<double> poisson, transient;
  for (const SpaceStudy* study : studies) {
    if (!poisson.empty()) data.rows.insert(data.rows.end(), 2, {});
    for (std::size_t i = 0; i < study->points.size(); ++i)
      data.rows.push_back({static_cast<double>(study->points[i].tets), study->errors.at_rest_error[i],
                           study->errors.quadratic_error[i], study->errors.transient_error[i]});
    poisson.push_back(study->points.front().poisson);
    transient.push_back(std::isfinite(study->errors.transient_error.front()) ? 1 : 0);
  }
  plot.data.push_back(std::move(data));
  plot.set("heading", scene + ": deflection of the loaded patch");
  plot.set("studies", static_cast<double>(poisson.size()));
  plot.set("poisson", poisson);
  plot.set("transient", transient);
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
