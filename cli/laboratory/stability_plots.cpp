// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/stability_plots.h"

#include <algorithm>
#include <array>

namespace tactus::cli {
namespace {

using sim::study::Series;
using sim::study::Study;

/// The plot STUDY-NAME.gp of one study and the series that it needs; each becomes the data block of its name, with _ for - and dot.
struct Recipe {
  const char* study;
  const char* name;
  const char* caption;
  std::array<const char*, 6> series;  // the rest is null
  int width, height;
};

constexpr Recipe kRecipes[] = {
    {"jury",
     "figure-4.16",
     "Step responses of thesis figure 4.16: above and below the critical sum of 700 N/m; the second user begins at 320 ms.",
     {"figure-4.16-a", "figure-4.16-b"},
     900,
     620},
    {"client",
     "figure-4.17",
     "Thesis figure 4.17: force on the hand and energy at the client's port. (a) no delay; (b) 100 ms; (c) 100 ms, damped by "
     "the client; (d) 100 ms, normal grip; (e) 100 ms, stiffer object.",
     {"a", "b", "c", "d", "e"},
     1000,
     1100},
};

const Series* find(const Study& study, const std::string& name) {
  const auto found = std::find_if(study.series.begin(), study.series.end(), [&](const Series& s) { return s.name == name; });
  return found == study.series.end() ? nullptr : &*found;
}

std::string block_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c == '-' || c == '.'; }, '_');
  return name;
}

}  // namespace

std::vector<StabilityPlot> stability_plots(std::span<const Study> studies) {
  std::vector<StabilityPlot> out;
  for (const Recipe& recipe : kRecipes) {
    const auto study = std::find_if(studies.begin(), studies.end(), [&](const Study& s) { return s.name == recipe.study; });
    if (study == studies.end()) continue;
    const std::string name = std::string(recipe.study) + "-" + recipe.name;
    StabilityPlot made{.plot = {.name = name, .program = name, .width = recipe.width, .height = recipe.height},
                       .caption = recipe.caption};
    bool complete = true;
    for (const char* wanted : recipe.series) {
      if (!wanted) continue;
      if (const Series* series = find(*study, wanted)) made.plot.data.push_back({block_name(wanted), series->rows});
      else complete = false;
    }
    if (complete) out.push_back(std::move(made));
  }
  return out;
}

}  // namespace tactus::cli
