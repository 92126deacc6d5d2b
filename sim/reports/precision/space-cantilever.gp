# SPDX-License-Identifier: Apache-2.0
# gnuplot -c space-cantilever.gp svg | png    makes space-cantilever.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 1100,560 font 'sans,11' }
else { set terminal svg size 1100,560 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'space-cantilever'.'.'.ARG1 }
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
30 0.763691 0.0350732 0.814981
240 0.486066 0.00803167 0.383441
1920 0.206847 0.00183923 0.0981456
15360 0.0645108 NaN NaN
EOD
$s1 << EOD
30 0.866396 0.110272 NaN
240 0.683593 0.028563 NaN
1920 0.391919 0.00739849 NaN
15360 0.153999 NaN NaN
EOD
$s2 << EOD
30 0.936293 0.176734 NaN
240 0.870503 0.052639 NaN
1920 0.694325 0.0156781 NaN
15360 0.409231 NaN NaN
EOD
$s3 << EOD
30 0.958398 0.207268 NaN
240 0.950219 0.0698826 NaN
1920 0.919521 0.0235616 NaN
15360 0.820504 NaN NaN
EOD
set logscale xy
set format x '10^{%L}'
set title 'cantilever: deflection of the loaded patch' noenhanced
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
