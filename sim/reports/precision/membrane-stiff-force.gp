# SPDX-License-Identifier: Apache-2.0
# gnuplot -c membrane-stiff-force.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 1100,680 font 'sans,11'; set output 'membrane-stiff-force.png' }
else { set terminal svg size 1100,680 font 'sans,13' background 'white'; set output 'membrane-stiff-force.svg' }
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
2.8534e-08 0.599782 0.1
EOD
$m1 << EOD
8.94459e-06 0.291795 0.1
EOD
$m2 << EOD
0.000223202 1.18274 16.6667
0.00022854 1.87094 8.33333
0.000223232 2.8968 4
0.000189403 3.4042 2
0.000135154 3.54599 1
EOD
$m3 << EOD
0.000696334 0.988926 16.6667
9.23672e-05 1.50198 8.33333
4.44581e-05 2.1892 4
1.02747e-05 2.47126 2
3.0867e-06 2.56231 1
EOD
$m4 << EOD
0.000747702 2.83586 16.6667
0.000107167 3.81114 8.33333
4.44595e-05 4.23092 4
1.02747e-05 4.65926 2
3.08678e-06 5.25207 1
EOD
$m5 << EOD
0.000747702 0.96902 16.6667
0.000107167 1.75541 8.33333
4.44595e-05 3.11029 4
1.02747e-05 6.07427 2
3.08678e-06 12.109 1
EOD
$m6 << EOD
0.000747976 0.0289283 16.6667
0.000107242 0.0576762 8.33333
4.44595e-05 0.119121 4
1.02748e-05 0.238441 2
3.08679e-06 0.47081 1
9.67343e-07 0.91258 0.5
2.74501e-07 1.21896 0.25
4.50092e-08 2.47615 0.1
EOD
$m7 << EOD
0.000228175 4.55004 16.6667
8.95556e-05 5.44397 8.33333
2.16834e-05 6.42598 4
3.8253e-06 6.9526 2
1.59514e-06 7.11527 1
EOD
$m8 << EOD
0.000228172 0.0568192 16.6667
8.95623e-05 0.113222 8.33333
2.1689e-05 0.233533 4
3.8271e-06 0.463029 2
1.59533e-06 0.930017 1
4.7687e-07 1.8487 0.5
1.39856e-07 2.80238 0.25
EOD
$m9 << EOD
0.000223261 0.01298 16.6667
0.000228615 0.0258699 8.33333
0.000223273 0.0538069 4
0.000189424 0.10742 2
0.000135165 0.214757 1
8.35598e-05 0.428122 0.5
4.71217e-05 0.856243 0.25
2.05203e-05 2.11288 0.1
EOD
$m10 << EOD
0.000223356 0.0397282 16.6667
0.000228626 0.0629097 8.33333
0.000223275 0.120313 4
0.000189424 0.235993 2
0.000135165 0.470095 1
8.35597e-05 0.882455 0.5
4.71217e-05 1.22302 0.25
2.05203e-05 2.44469 0.1
EOD
$m11 << EOD
0.0103634 0.00160778 16.6667
0.010451 0.00314487 8.33333
0.0104589 0.00658211 4
0.01046 0.0131197 2
0.0104602 0.0262482 1
0.0104603 0.0524276 0.5
0.0104603 0.105492 0.25
0.0104603 0.258393 0.1
EOD
$m12 << EOD
0.0053554 0.00752304 16.6667
0.00552962 0.0148744 8.33333
0.0054565 0.0309372 4
0.00546444 0.061846 2
0.00546516 0.123473 1
0.00546526 0.250352 0.5
0.00546527 0.495559 0.25
0.00546528 1.23501 0.1
EOD
$rings << EOD
0.000135154 3.54599
3.0867e-06 2.56231
3.08678e-06 5.25207
3.08678e-06 12.109
3.08679e-06 0.47081
1.59514e-06 7.11527
1.59533e-06 0.930017
0.000135165 0.214757
0.000135165 0.470095
0.0104602 0.0262482
0.00546516 0.123473
EOD
set logscale xy
set format x '10^{%L}'
set format y '10^{%L}'
set mxtics 1
set mytics 1
set title "stiff membrane: E 10 MPa, load -sin^2(2 pi t) N at the centre; marks: h in ms, ringed: 1 ms" noenhanced
set xlabel 'relative error of the force at the probe (the reference is off by 9.4e-12)'
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
