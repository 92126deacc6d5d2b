# SPDX-License-Identifier: Apache-2.0
# gnuplot -c space-membrane.gp svg | png    makes space-membrane.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 1100,560 font 'sans,11' }
else { set terminal svg size 1100,560 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'space-membrane'.'.'.ARG1 }
set encoding utf8
set datafile missing 'NaN'
set border 3 linecolor rgb '#444444'
set tics nomirror out textcolor rgb '#222222'
set grid linecolor rgb '#d9d9d9' linewidth 0.6 dashtype solid
set key textcolor rgb '#222222' spacing 1.15
set linetype 1 linecolor rgb '#0072B2' linewidth 2 pointtype 7 pointsize 0.7
set linetype 2 linecolor rgb '#D55E00' linewidth 2 pointtype 7 pointsize 0.7
set linetype 3 linecolor rgb '#009E73' linewidth 2 pointtype 7 pointsize 0.7
set linetype 4 linecolor rgb '#CC79A7' linewidth 2 pointtype 7 pointsize 0.7
set linetype 5 linecolor rgb '#E69F00' linewidth 2 pointtype 7 pointsize 0.7
set linetype 6 linecolor rgb '#56B4E9' linewidth 2 pointtype 7 pointsize 0.7
set linetype 7 linecolor rgb '#000000' linewidth 2 pointtype 7 pointsize 0.7
$s0 << EOD
1920 0.851172 0.0698513 0.157311
15360 0.638908 0.0183558 0.0455551
51840 0.456168 NaN 0.0181423
122880 0.328147 0.0048236 NaN
EOD
set logscale xy
set format x '10^{%L}'
set title 'membrane: deflection of the loaded patch' noenhanced
set xlabel 'tetrahedra'
set ylabel 'relative error of the deflection'
set key outside right top Left reverse
plot $s0 using 1:2 with linespoints linetype 1 title 'linear, nu 0.45', \
  $s0 using 1:3 with points linetype 1 pointtype 4 pointsize 1.2 title 'quadratic, nu 0.45', \
  $s0 using 1:4 with linespoints linetype 1 dashtype 2 pointtype 9 title 'linear in time, nu 0.45, against the finest'
