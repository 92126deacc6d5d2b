# SPDX-License-Identifier: Apache-2.0
# gnuplot -c membrane-force.gp svg | png    makes membrane-force.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 1100,680 font 'sans,11' }
else { set terminal svg size 1100,680 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'membrane-force'.'.'.ARG1 }
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
$m0 << EOD
0.337881 0.0199397 4
0.0444215 0.0257315 3.33333
0.00325643 0.0211841 2
0.0013201 0.0413108 1
0.000141122 0.0840342 0.5
2.71511e-05 0.178712 0.25
EOD
$m1 << EOD
0.00346187 0.0129206 3.33333
0.00325643 0.0236164 2
0.0013201 0.0430494 1
0.000141122 0.0860958 0.5
2.71511e-05 0.17011 0.25
EOD
$m2 << EOD
0.070782 0.00882185 3.33333
0.0660328 0.0145624 2
0.0633479 0.0285111 1
0.0626081 0.0410699 0.5
0.0625765 0.084274 0.25
EOD
$m3 << EOD
0.485459 0.318175 4
0.0173222 0.326441 3.33333
0.00848991 0.421575 2
0.00371499 0.783986 1
0.00199959 1.32721 0.5
0.00131236 2.50046 0.25
EOD
$m4 << EOD
0.00142695 0.256493 4
0.00255837 0.315269 3.33333
0.00137205 0.437583 2
0.00095986 0.916792 1
0.000402437 2.01285 0.5
EOD
$m5 << EOD
0.00166246 1.00461 4
0.00248674 1.02805 3.33333
0.00135929 1.40418 2
0.00095958 2.06708 1
EOD
$m6 << EOD
0.00166246 7.57278 4
0.00248674 6.60247 3.33333
0.00135929 9.27846 2
0.00095958 18.196 1
EOD
$m7 << EOD
0.757409 0.0499801 16.6667
0.00158062 0.178653 4
0.00250252 0.220301 3.33333
0.001362 0.365485 2
0.000959694 0.740135 1
0.000401075 1.45626 0.5
6.48263e-05 2.93692 0.25
EOD
$m8 << EOD
0.986664 1.49716 8.33333
0.00253359 1.73815 4
0.00188134 1.63501 3.33333
0.000895796 2.10053 2
0.000777224 2.96253 1
EOD
$m9 << EOD
0.00253506 0.359293 4
0.00188074 0.535995 3.33333
0.000895738 0.790973 2
0.000777235 1.51205 1
0.000138542 2.94361 0.5
EOD
$m10 << EOD
0.568356 0.0788795 4
0.0177862 0.0949964 3.33333
0.00893919 0.160682 2
0.00400035 0.319884 1
0.00214338 0.728007 0.5
0.00137513 1.29711 0.25
EOD
$m11 << EOD
0.896949 0.122525 8.33333
0.559127 0.250664 4
0.0184546 0.300433 3.33333
0.00919245 0.502839 2
0.00406383 1.03368 1
0.00215809 2.09957 0.5
EOD
$m12 << EOD
0.710302 0.00166673 16.6667
0.714212 0.00350735 8.33333
0.715243 0.00644992 4
0.715342 0.00567216 3.33333
0.715488 0.013946 2
0.71555 0.0231206 1
0.715566 0.0403946 0.5
0.71557 0.0823258 0.25
EOD
$m13 << EOD
0.183665 0.00699841 16.6667
0.24784 0.0143168 8.33333
0.241973 0.037258 4
0.242019 0.0345992 3.33333
0.24228 0.064936 2
0.242456 0.117227 1
0.242505 0.26359 0.5
0.242517 0.477669 0.25
EOD
$rings << EOD
0.0013201 0.0413108
0.0013201 0.0430494
0.0633479 0.0285111
0.00371499 0.783986
0.00095986 0.916792
0.00095958 2.06708
0.00095958 18.196
0.000959694 0.740135
0.000777224 2.96253
0.000777235 1.51205
0.00400035 0.319884
0.00406383 1.03368
0.71555 0.0231206
0.242456 0.117227
EOD
set logscale xy
set format x '10^{%L}'
set format y '10^{%L}'
set mxtics 1
set mytics 1
set title 'membrane: E 10 kPa, load -sin^2(2 pi t) N at the centre; marks: h in ms, ringed: 1 ms' noenhanced
set xlabel 'relative error of the force at the probe (the reference is off by 2.1e-10)' noenhanced
set ylabel 'seconds of one core per simulated second'
set yrange [*:3<*]
set key outside right top Left reverse samplen 2.5
plot $m0 using 1:2 with linespoints linetype 8 dashtype 1 pointtype 5 pointsize 0.8 title 'chosen' noenhanced, \
  $m0 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 8 notitle, \
  $m1 using 1:2 with linespoints linetype 7 dashtype 1 pointtype 7 pointsize 0.8 title 'velocity Verlet' noenhanced, \
  $m1 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 7 notitle, \
  $m2 using 1:2 with linespoints linetype 7 dashtype 2 pointtype 4 pointsize 0.8 title 'velocity Verlet (linear)' noenhanced, \
  $m3 using 1:2 with linespoints linetype 1 dashtype 1 pointtype 7 pointsize 0.8 title 'backward Euler 1x PCG' noenhanced, \
  $m3 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 1 notitle, \
  $m4 using 1:2 with linespoints linetype 2 dashtype 1 pointtype 7 pointsize 0.8 title 'Newmark 1x PCG' noenhanced, \
  $m4 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 2 notitle, \
  $m5 using 1:2 with linespoints linetype 2 dashtype 2 pointtype 4 pointsize 0.8 title 'Newmark Newton PCG' noenhanced, \
  $m5 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 2 notitle, \
  $m6 using 1:2 with linespoints linetype 2 dashtype 3 pointtype 9 pointsize 0.8 title 'Newmark Newton Cholesky' noenhanced, \
  $m6 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 2 notitle, \
  $m7 using 1:2 with linespoints linetype 2 dashtype 4 pointtype 7 pointsize 0.8 title 'Newmark 2x prefactored' noenhanced, \
  $m7 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 2 notitle, \
  $m8 using 1:2 with linespoints linetype 3 dashtype 1 pointtype 7 pointsize 0.8 title 'TR-BDF2 Newton PCG' noenhanced, \
  $m8 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 3 notitle, \
  $m9 using 1:2 with linespoints linetype 3 dashtype 2 pointtype 4 pointsize 0.8 title 'TR-BDF2 2x prefactored' noenhanced, \
  $m9 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 3 notitle, \
  $m10 using 1:2 with linespoints linetype 5 dashtype 1 pointtype 7 pointsize 0.8 title 'projective 1x' noenhanced, \
  $m10 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 5 notitle, \
  $m11 using 1:2 with linespoints linetype 5 dashtype 2 pointtype 4 pointsize 0.8 title 'projective 3x' noenhanced, \
  $m11 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 5 notitle, \
  $m12 using 1:2 with linespoints linetype 4 dashtype 1 pointtype 7 pointsize 0.8 title 'modal 20 (linear)' noenhanced, \
  $m13 using 1:2 with linespoints linetype 4 dashtype 2 pointtype 4 pointsize 0.8 title 'modal 100 (linear)' noenhanced, \
  $rings using 1:2 with points pointtype 6 pointsize 1.8 linewidth 1.5 linecolor rgb '#222222' notitle, \
  1 with lines linewidth 1.5 linecolor rgb '#222222' title 'real time; at 1 kHz, 1 ms per step'
