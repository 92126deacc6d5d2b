# SPDX-License-Identifier: Apache-2.0
# gnuplot -c membrane-stiff-energy.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 1100,680 font 'sans,11'; set output 'membrane-stiff-energy.png' }
else { set terminal svg size 1100,680 font 'sans,13' background 'white'; set output 'membrane-stiff-energy.svg' }
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
1.43127e-06 0.599782 0.1
EOD
$m1 << EOD
0.000110261 0.291795 0.1
EOD
$m2 << EOD
0.0179538 1.18274 16.6667
0.0164249 1.87094 8.33333
0.0155046 2.8968 4
0.012855 3.4042 2
0.00881074 3.54599 1
EOD
$m3 << EOD
0.0508398 0.988926 16.6667
0.014548 1.50198 8.33333
0.00314261 2.1892 4
0.000864711 2.47126 2
0.000290023 2.56231 1
EOD
$m4 << EOD
0.0509027 2.83586 16.6667
0.0145466 3.81114 8.33333
0.00314245 4.23092 4
0.00086471 4.65926 2
0.000290026 5.25207 1
EOD
$m5 << EOD
0.0509027 0.96902 16.6667
0.0145466 1.75541 8.33333
0.00314245 3.11029 4
0.00086471 6.07427 2
0.000290026 12.109 1
EOD
$m6 << EOD
0.0509032 0.0289283 16.6667
0.0145465 0.0576762 8.33333
0.00314254 0.119121 4
0.000864711 0.238441 2
0.00029003 0.47081 1
7.45007e-05 0.91258 0.5
2.021e-05 1.21896 0.25
2.807e-06 2.47615 0.1
EOD
$m7 << EOD
0.0299989 4.55004 16.6667
0.0076976 5.44397 8.33333
0.00171421 6.42598 4
0.000575699 6.9526 2
0.000148897 7.11527 1
EOD
$m8 << EOD
0.0300005 0.0568192 16.6667
0.00769809 0.113222 8.33333
0.00171433 0.233533 4
0.000575731 0.463029 2
0.000148903 0.930017 1
3.8347e-05 1.8487 0.5
1.2677e-05 2.80238 0.25
EOD
$m9 << EOD
0.0179613 0.01298 16.6667
0.0164258 0.0258699 8.33333
0.0155045 0.0538069 4
0.0128547 0.10742 2
0.00881056 0.214757 1
0.00525363 0.428122 0.5
0.00289564 0.856243 0.25
0.00124419 2.11288 0.1
EOD
$m10 << EOD
0.0179488 0.0397282 16.6667
0.0164225 0.0629097 8.33333
0.0155036 0.120313 4
0.0128544 0.235993 2
0.00881045 0.470095 1
0.0052536 0.882455 0.5
0.00289563 1.22302 0.25
0.00124419 2.44469 0.1
EOD
$m11 << EOD
0.114269 0.00160778 16.6667
0.117715 0.00314487 8.33333
0.117431 0.00658211 4
0.117358 0.0131197 2
0.117339 0.0262482 1
0.117335 0.0524276 0.5
0.117334 0.105492 0.25
0.117333 0.258393 0.1
EOD
$m12 << EOD
0.0432523 0.00752304 16.6667
0.0481647 0.0148744 8.33333
0.0606791 0.0309372 4
0.0616343 0.061846 2
0.0616153 0.123473 1
0.0616102 0.250352 0.5
0.061609 0.495559 0.25
0.0616086 1.23501 0.1
EOD
$rings << EOD
0.00881074 3.54599
0.000290023 2.56231
0.000290026 5.25207
0.000290026 12.109
0.00029003 0.47081
0.000148897 7.11527
0.000148903 0.930017
0.00881056 0.214757
0.00881045 0.470095
0.117339 0.0262482
0.0616153 0.123473
EOD
set logscale xy
set format x '10^{%L}'
set format y '10^{%L}'
set mxtics 1
set mytics 1
set title "stiff membrane: E 10 MPa, load -sin^2(2 pi t) N at the centre; marks: h in ms, ringed: 1 ms" noenhanced
set xlabel 'relative error of energy (the reference is off by 6.4e-10)'
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
