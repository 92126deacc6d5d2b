# SPDX-License-Identifier: Apache-2.0
# gnuplot -c membrane-displacement.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 1100,680 font 'sans,11'; set output 'membrane-displacement.png' }
else { set terminal svg size 1100,680 font 'sans,13' background 'white'; set output 'membrane-displacement.svg' }
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
8.82557e-05 0.0191872 3.33333
3.17778e-05 0.0312383 2
7.95321e-06 0.0622721 1
1.98877e-06 0.124272 0.5
4.96998e-07 0.247645 0.25
EOD
$m1 << EOD
0.203209 0.00859894 3.33333
0.203207 0.0145134 2
0.203206 0.0286542 1
0.203206 0.0569231 0.5
0.203206 0.113162 0.25
EOD
$m2 << EOD
0.0978528 0.157461 16.6667
0.0520185 0.1804 8.33333
0.0259886 0.238874 4
0.0218082 0.262517 3.33333
0.0132798 0.369394 2
0.00672563 0.651895 1
0.00338946 1.19021 0.5
0.00169987 2.29662 0.25
EOD
$m3 << EOD
0.00378071 0.100585 16.6667
0.000986375 0.131734 8.33333
0.000235126 0.205205 4
0.00016419 0.236589 3.33333
5.95631e-05 0.359033 2
1.49326e-05 0.68671 1
3.73967e-06 1.29663 0.5
9.35267e-07 2.55636 0.25
EOD
$m4 << EOD
0.00397341 0.753793 16.6667
0.00103382 0.687645 8.33333
0.000245943 0.72424 4
0.000171684 0.740521 3.33333
6.22554e-05 0.998206 2
1.56103e-05 1.33237 1
3.90839e-06 2.52352 0.5
EOD
$m5 << EOD
0.00397341 2.77106 16.6667
0.00103382 3.86341 8.33333
0.000245943 5.3655 4
0.000171684 5.74939 3.33333
6.22554e-05 8.69392 2
1.56103e-05 12.4917 1
EOD
$m6 << EOD
0.0324917 0.0335939 16.6667
0.0033376 0.0601271 8.33333
0.00024572 0.122605 4
0.000171667 0.145013 3.33333
6.19387e-05 0.24011 2
1.5605e-05 0.478047 1
3.90795e-06 0.955229 0.5
9.79504e-07 1.04812 0.25
EOD
$m7 << EOD
0.00194855 0.842583 16.6667
0.000505405 0.822588 8.33333
0.000119555 1.04041 4
8.32675e-05 1.15546 3.33333
3.00949e-05 1.32155 2
7.54042e-06 2.4846 1
EOD
$m8 << EOD
0.0220136 0.0528157 16.6667
0.000735819 0.116444 8.33333
0.000112084 0.237374 4
7.8671e-05 0.283965 3.33333
2.99965e-05 0.470952 2
7.53806e-06 0.9408 1
2.05056e-06 1.10745 0.5
4.75405e-07 1.93471 0.25
EOD
$m9 << EOD
0.0304818 0.053675 4
0.0225465 0.0646332 3.33333
0.0136578 0.106978 2
0.0069536 0.211853 1
0.00352354 0.424634 0.5
0.00177582 0.847244 0.25
EOD
$m10 << EOD
0.11108 0.0438982 16.6667
0.0536606 0.0842939 8.33333
0.0271404 0.17158 4
0.0228043 0.2041 3.33333
0.0139184 0.335751 2
0.00705505 0.650286 1
0.00355383 1.08826 0.5
0.00178406 1.45738 0.25
EOD
$m11 << EOD
0.21745 0.00152939 16.6667
0.21762 0.00311508 8.33333
0.217663 0.00641874 4
0.217667 0.00767587 3.33333
0.217673 0.0128512 2
0.217676 0.0256591 1
0.217676 0.050775 0.5
0.217676 0.101668 0.25
EOD
$m12 << EOD
0.20435 0.00740781 16.6667
0.204533 0.0148108 8.33333
0.20458 0.0308455 4
0.204584 0.0367448 3.33333
0.204591 0.0618722 2
0.204593 0.123093 1
0.204594 0.244903 0.5
0.204594 0.491296 0.25
EOD
$rings << EOD
7.95321e-06 0.0622721
0.203206 0.0286542
0.00672563 0.651895
1.49326e-05 0.68671
1.56103e-05 1.33237
1.56103e-05 12.4917
1.5605e-05 0.478047
7.54042e-06 2.4846
7.53806e-06 0.9408
0.0069536 0.211853
0.00705505 0.650286
0.217676 0.0256591
0.204593 0.123093
EOD
set logscale xy
set format x '10^{%L}'
set format y '10^{%L}'
set mxtics 1
set mytics 1
set title "membrane: E 10 kPa, load -sin^2(2 pi t) N at the centre; marks: h in ms, ringed: 1 ms" noenhanced
set xlabel 'relative error of displacements (the reference is off by 2.0e-10)'
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
