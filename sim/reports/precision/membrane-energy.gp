# SPDX-License-Identifier: Apache-2.0
# gnuplot -c membrane-energy.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 1100,680 font 'sans,11'; set output 'membrane-energy.png' }
else { set terminal svg size 1100,680 font 'sans,13' background 'white'; set output 'membrane-energy.svg' }
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
6.03773e-05 0.0191872 3.33333
2.19687e-05 0.0312383 2
5.48054e-06 0.0622721 1
1.37478e-06 0.124272 0.5
3.43917e-07 0.247645 0.25
EOD
$m1 << EOD
0.0548653 0.00859894 3.33333
0.0548544 0.0145134 2
0.0548498 0.0286542 1
0.0548488 0.0569231 0.5
0.0548485 0.113162 0.25
EOD
$m2 << EOD
0.141277 0.157461 16.6667
0.0810634 0.1804 8.33333
0.0422746 0.238874 4
0.0357317 0.262517 3.33333
0.0220961 0.369394 2
0.0113194 0.651895 1
0.00573854 1.19021 0.5
0.0028895 2.29662 0.25
EOD
$m3 << EOD
0.00171077 0.100585 16.6667
0.000472913 0.131734 8.33333
0.000114884 0.205205 4
7.98116e-05 0.236589 3.33333
2.8783e-05 0.359033 2
7.20499e-06 0.68671 1
1.80609e-06 1.29663 0.5
4.49918e-07 2.55636 0.25
EOD
$m4 << EOD
0.00185445 0.753793 16.6667
0.000487881 0.687645 8.33333
0.000116465 0.72424 4
8.07549e-05 0.740521 3.33333
2.89408e-05 0.998206 2
7.20268e-06 1.33237 1
1.79768e-06 2.52352 0.5
EOD
$m5 << EOD
0.00185445 2.77106 16.6667
0.000487881 3.86341 8.33333
0.000116465 5.3655 4
8.07549e-05 5.74939 3.33333
2.89408e-05 8.69392 2
7.20268e-06 12.4917 1
EOD
$m6 << EOD
0.0964563 0.0335939 16.6667
0.00412683 0.0601271 8.33333
8.2507e-05 0.122605 4
9.33505e-05 0.145013 3.33333
2.71481e-05 0.24011 2
7.21593e-06 0.478047 1
1.79807e-06 0.955229 0.5
5.17208e-07 1.04812 0.25
EOD
$m7 << EOD
0.00161385 0.842583 16.6667
0.000408028 0.822588 8.33333
9.36299e-05 1.04041 4
6.47694e-05 1.15546 3.33333
2.3104e-05 1.32155 2
5.75623e-06 2.4846 1
EOD
$m8 << EOD
0.0281002 0.0528157 16.6667
0.000483378 0.116444 8.33333
9.88371e-05 0.237374 4
4.54351e-05 0.283965 3.33333
2.22308e-05 0.470952 2
5.72544e-06 0.9408 1
1.08853e-06 1.10745 0.5
3.58191e-07 1.93471 0.25
EOD
$m9 << EOD
0.0515666 0.053675 4
0.036122 0.0646332 3.33333
0.0237359 0.106978 2
0.0127125 0.211853 1
0.0065843 0.424634 0.5
0.00335232 0.847244 0.25
EOD
$m10 << EOD
0.116254 0.0438982 16.6667
0.092553 0.0842939 8.33333
0.0495778 0.17158 4
0.0419312 0.2041 3.33333
0.0259276 0.335751 2
0.0132835 0.650286 1
0.00673028 1.08826 0.5
0.00338946 1.45738 0.25
EOD
$m11 << EOD
0.203111 0.00152939 16.6667
0.203104 0.00311508 8.33333
0.203103 0.00641874 4
0.203103 0.00767587 3.33333
0.203102 0.0128512 2
0.203102 0.0256591 1
0.203102 0.050775 0.5
0.203102 0.101668 0.25
EOD
$m12 << EOD
0.102252 0.00740781 16.6667
0.102235 0.0148108 8.33333
0.102231 0.0308455 4
0.10223 0.0367448 3.33333
0.10223 0.0618722 2
0.102229 0.123093 1
0.102229 0.244903 0.5
0.102229 0.491296 0.25
EOD
$rings << EOD
5.48054e-06 0.0622721
0.0548498 0.0286542
0.0113194 0.651895
7.20499e-06 0.68671
7.20268e-06 1.33237
7.20268e-06 12.4917
7.21593e-06 0.478047
5.75623e-06 2.4846
5.72544e-06 0.9408
0.0127125 0.211853
0.0132835 0.650286
0.203102 0.0256591
0.102229 0.123093
EOD
set logscale xy
set format x '10^{%L}'
set format y '10^{%L}'
set mxtics 1
set mytics 1
set title "membrane: E 10 kPa, load -sin^2(2 pi t) N at the centre; marks: h in ms, ringed: 1 ms" noenhanced
set xlabel 'relative error of energy (the reference is off by 1.4e-10)'
set ylabel 'seconds of one core per simulated second'
set yrange [*:3<*]
set key outside right top Left reverse samplen 2.5
plot $m0 using 1:2 with linespoints linetype 7 dashtype 1 pointtype 7 pointsize 0.8 title 'symplectic Euler', \
  $m0 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 7 notitle, \
  $m1 using 1:2 with linespoints linetype 7 dashtype 2 pointtype 4 pointsize 0.8 title 'symplectic Euler (linear)', \
  $m2 using 1:2 with linespoints linetype 1 dashtype 1 pointtype 7 pointsize 0.8 title 'backward Euler 1x PCG', \
  $m2 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 1 notitle, \
  $m3 using 1:2 with linespoints linetype 2 dashtype 1 pointtype 7 pointsize 0.8 title 'Newmark 1x PCG', \
  $m3 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 2 notitle, \
  $m4 using 1:2 with linespoints linetype 2 dashtype 2 pointtype 4 pointsize 0.8 title 'Newmark Newton PCG', \
  $m4 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 2 notitle, \
  $m5 using 1:2 with linespoints linetype 2 dashtype 3 pointtype 9 pointsize 0.8 title 'Newmark Newton Cholesky', \
  $m5 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 2 notitle, \
  $m6 using 1:2 with linespoints linetype 2 dashtype 4 pointtype 7 pointsize 0.8 title 'Newmark 2x prefactored', \
  $m6 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 2 notitle, \
  $m7 using 1:2 with linespoints linetype 3 dashtype 1 pointtype 7 pointsize 0.8 title 'TR-BDF2 Newton PCG', \
  $m7 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 3 notitle, \
  $m8 using 1:2 with linespoints linetype 3 dashtype 2 pointtype 4 pointsize 0.8 title 'TR-BDF2 2x prefactored', \
  $m8 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 3 notitle, \
  $m9 using 1:2 with linespoints linetype 5 dashtype 1 pointtype 7 pointsize 0.8 title 'projective 1x', \
  $m9 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 5 notitle, \
  $m10 using 1:2 with linespoints linetype 5 dashtype 2 pointtype 4 pointsize 0.8 title 'projective 3x', \
  $m10 using 1:2:(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' textcolor linetype 5 notitle, \
  $m11 using 1:2 with linespoints linetype 4 dashtype 1 pointtype 7 pointsize 0.8 title 'modal 20 (linear)', \
  $m12 using 1:2 with linespoints linetype 4 dashtype 2 pointtype 4 pointsize 0.8 title 'modal 100 (linear)', \
  $rings using 1:2 with points pointtype 6 pointsize 1.8 linewidth 1.5 linecolor rgb '#222222' notitle, \
  1 with lines linewidth 1.5 linecolor rgb '#222222' title 'real time; at 1 kHz, 1 ms per step'
