// SPDX-License-Identifier: Apache-2.0
#include "cli/stability_plots.h"

#include <algorithm>
#include <initializer_list>

namespace tactus::cli {
namespace {

using study::Series;
using study::Study;

/// A plot of one study and the series that it needs; each becomes the data block of its name, with _ for - and dot.
struct Recipe {
  const char* study;
  const char* name;
  const char* caption;
  std::vector<const char*> series;
  int width, height;
  const char* script;
};

const std::vector<Recipe>& recipes() {
  static const std::vector<Recipe> all{
      {"jury",
       "limit",
       "Largest sum of server stiffnesses over the deformation rate: measured by step responses (points), Jury's criterion "
       "(lines).",
       {"over-n-figure", "over-n-linear", "over-n-heavy", "over-n-vertex"},
       900,
       560,
       R"(set logscale xy
set xlabel 'N = T_n / T_s  (deformation every N ms)'
set ylabel 'largest sum of k_s  [N/m]'
set xrange [0.9:60]
set xtics (1,2,3,5,10,20,50)
set format y '10^{%L}'
set arrow from 16.667, graph 0 to 16.667, graph 1 nohead linecolor rgb '#888888' dashtype 2
set label '60 Hz' at 16.1, graph 0.035 right textcolor rgb '#666666'
set key bottom left reverse Left samplen 2
plot $over_n_heavy using 1:2 with lines linetype 3 title 'k_o 1000 N/m, b_o 10 N s/m, m_o 100 g', \
     $over_n_heavy using 1:3 with points linetype 3 notitle, \
     $over_n_figure using 1:2 with lines linetype 1 title 'k_o 100 N/m, b_o 1 N s/m, m_o 10 g (figure 4.16)', \
     $over_n_figure using 1:3 with points linetype 1 notitle, \
     $over_n_linear using 1:2 with lines linetype 2 dashtype 2 title 'the same, surface approached linearly', \
     $over_n_linear using 1:3 with points linetype 2 notitle, \
     $over_n_vertex using 1:2 with lines linetype 4 title 'vertex of the slab alone, 4.5 g', \
     $over_n_vertex using 1:3 with points linetype 4 notitle
)"},
      {"jury",
       "figure-4.16",
       "Step responses of thesis figure 4.16: above and below the critical sum of 700 N/m; the second user begins at 320 ms.",
       {"figure-4.16-a", "figure-4.16-b"},
       900,
       620,
       R"(set multiplot layout 2,1 margins 0.09,0.97,0.10,0.95 spacing 0.02,0.12
set ylabel 'surface x_o  [mm]'
set xrange [0:800]
set arrow 1 from 320, graph 0 to 320, graph 1 nohead linecolor rgb '#888888' dashtype 2
set label 1 'second user' at 326, graph 0.93 textcolor rgb '#666666'
set yrange [-6:8]
set title '(a) sum of k_s = 720 N/m' offset 0,-0.6
plot $figure_4_16_a using ($1*1e3):2 with steps linetype 2 notitle
set yrange [0:2.2]
set title '(b) sum of k_s = 680 N/m' offset 0,-0.6
set xlabel 'time  [ms]'
plot $figure_4_16_b using ($1*1e3):2 with steps linetype 1 notitle
unset multiplot
)"},
  };
  return all;
}

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
  for (const Recipe& recipe : recipes()) {
    const auto study = std::find_if(studies.begin(), studies.end(), [&](const Study& s) { return s.name == recipe.study; });
    if (study == studies.end()) continue;
    StabilityPlot made{.plot = {.name = std::string(recipe.study) + "-" + recipe.name, .script = recipe.script, .data = {}},
                       .caption = recipe.caption};
    made.plot.width = recipe.width;
    made.plot.height = recipe.height;
    for (const char* name : recipe.series)
      if (const Series* series = find(*study, name)) made.plot.data.push_back({block_name(name), series->rows});
    if (made.plot.data.size() == recipe.series.size()) out.push_back(std::move(made));
  }
  return out;
}

}  // namespace tactus::cli
