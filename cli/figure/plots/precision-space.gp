# SPDX-License-Identifier: Apache-2.0
# Error of the deflection over the size of the mesh.
#   heading           text
#   studies           how many;   poisson[] of each; transient[] 1: it has errors in time
#   $data             study behind study: tetrahedra, error at rest of linear and of quadratic elements, error in time
set logscale xy
set format x '10^{%L}'
set title heading noenhanced
set xlabel 'tetrahedra'
set ylabel 'relative error of the deflection'
set key outside right top Left reverse
plots = ''
do for [i=1:studies] {
  data = sprintf('%s $data index %d using 1:', i == 1 ? 'plot' : ',', i-1)
  nu = sprintf('nu %.3g', poisson[i])
  plots = plots.data.sprintf("2 with linespoints linetype %d title 'linear, %s'", i, nu)
  data = sprintf(', $data index %d using 1:', i-1)
  plots = plots.data.sprintf("3 with points linetype %d pointtype 4 pointsize 1.2 title 'quadratic, %s'", i, nu)
  if (transient[i]) {
    plots = plots.data.sprintf("4 with linespoints linetype %d dashtype 2 pointtype 9 title 'linear in time, %s, against the finest'", i, nu)
  }
}
eval plots
