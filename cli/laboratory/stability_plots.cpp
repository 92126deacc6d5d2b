// SPDX-License-Identifier: Apache-2.0
#include "cli/laboratory/stability_plots.h"

#include <algorithm>
#include <array>

namespace tactus::cli {
namespace {

using sim::study::Series;
using sim::study::Study;

/// A plot of one study and the series that it needs; each becomes the data block of its name, with _ for - and dot.
struct Recipe {
  const char* study;
  const char* name;
  const char* caption;
  std::array<const char*, 6> series;  // the rest is null
  int width, height;
  const char* script;
};

constexpr Recipe kRecipes[] = {
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
    {"wall",
     "device-damping",
     "Largest wall stiffness over the damping of the device, eq. 2.3 (lines), with the passivity observer (points); crosses: "
     "the "
     "device alone against the wall, stable.",
     {"damping-1khz", "damping-60hz"},
     900,
     560,
     R"(set logscale xy
set xlabel 'damping of the device b_d  [N s/m]'
set ylabel 'largest wall stiffness k_o  [N/m]'
set xrange [0.04:12]
set yrange [3:50000]
set format y '10^{%L}'
set key top left reverse Left samplen 2
plot $damping_1khz using 1:2 with lines linetype 1 title 'b_d = k_o T / 2 at 1 kHz', \
     $damping_1khz using 1:3 with points linetype 1 title 'passivity observer, 1 kHz', \
     $damping_1khz using 1:4 with points linetype 1 pointtype 2 pointsize 1 title 'device alone stable, 1 kHz', \
     $damping_60hz using 1:2 with lines linetype 2 title 'b_d = k_o T / 2 at 60 Hz', \
     $damping_60hz using 1:3 with points linetype 2 title 'passivity observer, 60 Hz', \
     $damping_60hz using 1:4 with points linetype 2 pointtype 2 pointsize 1 title 'device alone stable, 60 Hz'
)"},
    {"wall",
     "z-width",
     "Which stiffness and damping a wall may have at 1 kHz with a device of 0.35 N s/m: measured (points), eqs. 2.3 and 2.4 "
     "(lines).",
     {"z-width"},
     900,
     560,
     R"(set logscale y
set xlabel 'damping of the wall b_o  [N s/m]'
set ylabel 'stiffness of the wall k_o  [N/m]'
set xrange [0:8]
set yrange [100:200000]
set format y '10^{%L}'
set samples 1000
set key bottom right reverse Left samplen 2
T = 1e-3
b_d = 0.35
plot 2*(b_d+x)/T with lines linetype 1 title 'b_d + b_o = k_o T / 2  (slow motion, eq. 2.4)', \
     $z_width using 1:($2 > 0 ? $2 : NaN) with points linetype 1 title 'passive in slow motion, observer', \
     (x < b_d ? 2*(b_d-x)/T : NaN) with lines linetype 2 title 'b_d = k_o T / 2 + b_o  (every motion)', \
     $z_width using 1:($3 > 0 ? $3 : NaN) with points linetype 2 title 'passive at 500 Hz, observer', \
     $z_width using 1:($5 > 0 ? $5 : NaN) with linespoints linetype 3 dashtype 2 title 'stable in a loose grip', \
     $z_width using 1:($4 > 0 ? $4 : NaN) with linespoints linetype 4 dashtype 2 title 'stable, device alone'
)"},
    {"client",
     "figure-4.17",
     "Thesis figure 4.17: force on the hand and energy at the client's port. (a) no delay; (b) 100 ms; (c) 100 ms, damped by "
     "the "
     "client; (d) 100 ms, normal grip; (e) 100 ms, stiffer object.",
     {"a", "b", "c", "d", "e"},
     1000,
     1100,
     R"(set multiplot layout 5,2 margins 0.075,0.985,0.055,0.97 spacing 0.085,0.04
set xrange [0:4]
unset key
text = "'(a) barely held, no delay' '(b) barely held, 100 ms' '(c) barely held, 100 ms, b_c = 5 N s/m' \
'(d) normal grip, 100 ms' '(e) barely held, 100 ms, k_o = 1000 N/m'"
do for [i=1:5] {
  name = word('a b c d e', i)
  set title word(text, i) offset 0,-0.7
  if (i == 5) { set xlabel 'time  [s]'; set format x '%g' } else { set format x '' }
  set ylabel 'force  [N]'
  set yrange [0:*]
  eval 'plot $'.name.' using 1:2 with lines linewidth 1.3 linetype '.(i == 2 ? '2' : '1')
  set title ' '
  set ylabel 'energy  [mJ]'
  set yrange [*:*]
  set arrow 1 from 0,0 to 4,0 nohead linecolor rgb '#888888' back
  eval 'plot $'.name.' using 1:3 with lines linewidth 1.3 linetype '.(i == 2 ? '2' : '1')
  unset arrow 1
}
unset multiplot
)"},
    {"fem",
     "map",
     "Which step size each method gets through over 1000 steps, as the material stiffens: a slab displaced by 2 mm and let go.",
     {"map-limit", "map-velocity-verlet", "map-backward-euler", "map-newmark", "map-tr-bdf2", "map-projective"},
     1100,
     720,
     R"(set multiplot layout 2,3 margins 0.085,0.985,0.09,0.945 spacing 0.055,0.12
set logscale xy
set xrange [50:2e10]
set yrange [5e-7:0.2]
set format xy '10^{%L}'
set xtics 100
set key off
names = 'map_velocity_verlet map_backward_euler map_newmark map_tr_bdf2 map_projective'
titles = 'velocity-verlet backward-euler newmark tr-bdf2 projective'
shape(v) = v == 2 ? 2 : 7
colour(v) = v == 2 ? 2 : v == 1 ? 5 : 1
do for [i=1:5] {
  set title word(titles, i) offset 0,-0.6
  if (i > 2) { set xlabel "Young's modulus E  [Pa]" }
  if (i == 1 || i == 4) { set ylabel 'step h  [s]' } else { unset ylabel }
  eval 'plot $'.word(names, i).' using 1:2:(shape($3)):(colour($3)) with points pointtype variable linecolor variable pointsize 0.65, \
    $map_limit using 1:2 with lines linetype 7 linewidth 1.6'
}
unset title
unset xlabel
unset border
unset tics
unset grid
set key center left reverse Left spacing 1.6 samplen 2
plot NaN with points linetype 1 pointsize 0.9 title 'stable', \
     NaN with points linetype 5 pointsize 0.9 title 'stable, tetrahedra inside out', \
     NaN with points linetype 2 pointtype 2 pointsize 0.9 title 'stopped with an error', \
     NaN with lines linetype 7 linewidth 1.6 title 'h {/Symbol w}_{max} = 2'
unset multiplot
)"},
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
    StabilityPlot made{.plot = {.name = std::string(recipe.study) + "-" + recipe.name, .script = recipe.script, .data = {}},
                       .caption = recipe.caption};
    made.plot.width = recipe.width;
    made.plot.height = recipe.height;
    bool complete = true;
    for (const char* name : recipe.series) {
      if (!name) continue;
      if (const Series* series = find(*study, name)) made.plot.data.push_back({block_name(name), series->rows});
      else complete = false;
    }
    if (complete) out.push_back(std::move(made));
  }
  return out;
}

}  // namespace tactus::cli
