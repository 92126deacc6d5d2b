# SPDX-License-Identifier: Apache-2.0
# gnuplot -c space-cantilever.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 1100,560 font 'sans,11'; set output 'space-cantilever.png' }
else { set terminal svg size 1100,560 font 'sans,13' background 'white'; set output 'space-cantilever.svg' }
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
30 0.763691048 0.0350731864 0.814976273
240 0.486066063 0.00803167293 0.383437853
1920 0.206846797 0.00183923323 0.0981453883
15360 0.0645107833 NaN NaN
EOD
$s1 << EOD
30 0.866396219 0.110272104 NaN
240 0.683593213 0.0285630274 NaN
1920 0.391918982 0.00739848523 NaN
15360 0.153998779 NaN NaN
EOD
$s2 << EOD
30 0.936292514 0.176734265 NaN
240 0.87050274 0.0526390049 NaN
1920 0.694324606 0.0156781416 NaN
15360 0.409230925 NaN NaN
EOD
$s3 << EOD
30 0.958397556 0.207268343 NaN
240 0.950219342 0.0698826327 NaN
1920 0.91952105 0.0235616413 NaN
15360 0.820504473 NaN NaN
EOD
set logscale xy
set format x '10^{%L}'
set title 'cantilever: deflection of the loaded patch'
set xlabel 'tetrahedra'
set ylabel 'relative error of the deflection'
set key outside right top Left reverse
plot $s0 using 1:2 with linespoints linetype 1 title 'linear, nu 0.3', \
  $s0 using 1:3 with points linetype 1 pointtype 4 pointsize 1.2 title 'quadratic, nu 0.3', \
  $s0 using 1:4 with linespoints linetype 1 dashtype 2 pointtype 9 title 'linear in time, nu 0.3, against the finest', \
  $s1 using 1:2 with linespoints linetype 2 title 'linear, nu 0.45', \
  $s1 using 1:3 with points linetype 2 pointtype 4 pointsize 1.2 title 'quadratic, nu 0.45', \
  $s2 using 1:2 with linespoints linetype 3 title 'linear, nu 0.49', \
  $s2 using 1:3 with points linetype 3 pointtype 4 pointsize 1.2 title 'quadratic, nu 0.49', \
  $s3 using 1:2 with linespoints linetype 4 title 'linear, nu 0.499', \
  $s3 using 1:3 with points linetype 4 pointtype 4 pointsize 1.2 title 'quadratic, nu 0.499'
