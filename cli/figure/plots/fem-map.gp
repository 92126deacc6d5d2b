# SPDX-License-Identifier: Apache-2.0
set multiplot layout 2,3 margins 0.085,0.985,0.09,0.945 spacing 0.055,0.12
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
