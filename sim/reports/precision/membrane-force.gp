# SPDX-License-Identifier: Apache-2.0
# gnuplot -c membrane-force.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 1100,680 font 'sans,11'; set output 'membrane-force.png' }
else { set terminal svg size 1100,680 font 'sans,13' background 'white'; set output 'membrane-force.svg' }
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
0.00169659 0.0191872 3.33333
0.0013856 0.0312383 2
0.00117239 0.0622721 1
0.000148732 0.124272 0.5
3.18659e-05 0.247645 0.25
EOD
$m1 << EOD
0.062938 0.00859894 3.33333
0.0637731 0.0145134 2
0.0632933 0.0286542 1
0.0626311 0.0569231 0.5
0.0625801 0.113162 0.25
EOD
$m2 << EOD
0.68003 0.238874 4
0.0173223 0.262517 3.33333
0.00848992 0.369394 2
0.003715 0.651895 1
0.0019996 1.19021 0.5
0.00131237 2.29662 0.25
EOD
$m3 << EOD
0.00142695 0.205205 4
0.00255838 0.236589 3.33333
0.00137206 0.359033 2
0.000959864 0.68671 1
0.000402449 1.29663 0.5
6.50926e-05 2.55636 0.25
EOD
$m4 << EOD
0.00166244 0.72424 4
0.00248674 0.740521 3.33333
0.00135931 0.998206 2
0.000959584 1.33237 1
0.00040109 2.52352 0.5
EOD
$m5 << EOD
0.00166244 5.3655 4
0.00248674 5.74939 3.33333
0.00135931 8.69392 2
0.000959584 12.4917 1
EOD
$m6 << EOD
0.998945 0.0601271 8.33333
0.00158511 0.122605 4
0.00248788 0.145013 3.33333
0.00136463 0.24011 2
0.000959707 0.478047 1
0.000401189 0.955229 0.5
6.44236e-05 1.04812 0.25
EOD
$m7 << EOD
0.986664 0.822588 8.33333
0.00253364 1.04041 4
0.00188131 1.15546 3.33333
0.000895821 1.32155 2
0.00077724 2.4846 1
EOD
$m8 << EOD
0.939112 0.116444 8.33333
0.00253382 0.237374 4
0.00188287 0.283965 3.33333
0.000895857 0.470952 2
0.000777395 0.9408 1
0.000138711 1.10745 0.5
2.682e-05 1.93471 0.25
EOD
$m9 << EOD
0.548802 0.053675 4
0.0177862 0.0646332 3.33333
0.00893921 0.106978 2
0.00400036 0.211853 1
0.00214339 0.424634 0.5
0.00137514 0.847244 0.25
EOD
$m10 << EOD
0.758056 0.17158 4
0.0184594 0.2041 3.33333
0.00919248 0.335751 2
0.00406385 0.650286 1
0.0021581 1.08826 0.5
0.00137826 1.45738 0.25
EOD
$m11 << EOD
0.710302 0.00152939 16.6667
0.714212 0.00311508 8.33333
0.715243 0.00641874 4
0.715342 0.00767587 3.33333
0.715488 0.0128512 2
0.71555 0.0256591 1
0.715566 0.050775 0.5
0.71557 0.101668 0.25
EOD
$m12 << EOD
0.183665 0.00740781 16.6667
0.24784 0.0148108 8.33333
0.241973 0.0308455 4
0.242019 0.0367448 3.33333
0.24228 0.0618722 2
0.242456 0.123093 1
0.242505 0.244903 0.5
0.242517 0.491296 0.25
EOD
$rings << EOD
0.00117239 0.0622721
0.0632933 0.0286542
0.003715 0.651895
0.000959864 0.68671
0.000959584 1.33237
0.000959584 12.4917
0.000959707 0.478047
0.00077724 2.4846
0.000777395 0.9408
0.00400036 0.211853
0.00406385 0.650286
0.71555 0.0256591
0.242456 0.123093
EOD
set logscale xy
set format x '10^{%L}'
set format y '10^{%L}'
set mxtics 1
set mytics 1
set title "membrane: E 10 kPa, load -sin^2(2 pi t) N at the centre; marks: h in ms, ringed: 1 ms" noenhanced
set xlabel 'relative error of the force at the probe (the reference is off by 1.4e-08)'
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
