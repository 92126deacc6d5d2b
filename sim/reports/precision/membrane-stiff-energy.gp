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
1.431275e-06 0.6085704 0.1
EOD
$m1 << EOD
0.0001102612 0.2974309 0.1
EOD
$m2 << EOD
0.01795376 1.186338 16.66667
0.01642488 2.333974 8.333333
0.01550463 3.6361 4
0.01285495 4.24809 2
0.008810744 4.391669 1
EOD
$m3 << EOD
0.05083983 1.232804 16.66667
0.01454805 1.865245 8.333333
0.003142614 2.586963 4
0.0008647115 2.886795 2
0.0002900228 3.047562 1
EOD
$m4 << EOD
0.05090274 3.461695 16.66667
0.01454656 4.481176 8.333333
0.003142453 5.031618 4
0.0008647099 5.826037 2
0.0002900258 6.577653 1
EOD
$m5 << EOD
0.05090274 0.4150622 16.66667
0.01454656 0.7482359 8.333333
0.003142453 1.312627 4
0.0008647099 2.571289 2
0.0002900258 4.713278 1
EOD
$m6 << EOD
0.05090337 0.02926095 16.66667
0.01454649 0.0586122 8.333333
0.003142509 0.123351 4
0.0008647103 0.2437354 2
0.0002900292 0.478805 1
7.450321e-05 0.9504584 0.5
2.020987e-05 1.328617 0.25
2.807015e-06 2.872133 0.1
EOD
$m7 << EOD
0.02999895 5.66395 16.66667
0.007697596 6.825862 8.333333
0.001714212 7.852018 4
0.0005756994 8.221824 2
0.0001488968 8.374667 1
EOD
$m8 << EOD
0.02999988 0.05679599 16.66667
0.007697898 0.1201478 8.333333
0.001714286 0.2326772 4
0.0005757217 0.4659605 2
0.0001489011 0.9335834 1
3.834698e-05 1.868111 0.5
8.872269e-06 3.414696 0.25
EOD
$m9 << EOD
0.01796129 0.01285637 16.66667
0.01642583 0.02553422 8.333333
0.01550451 0.0520823 4
0.01285472 0.1055687 2
0.008810557 0.2094695 1
0.005253633 0.4150833 0.5
0.002895639 0.8214589 0.25
0.001244194 2.092804 0.1
EOD
$m10 << EOD
0.01794883 0.03979728 16.66667
0.01642253 0.06289032 8.333333
0.01550356 0.1244818 4
0.0128544 0.2410381 2
0.008810449 0.4748424 1
0.005253599 0.9404242 0.5
0.00289563 1.266607 0.25
0.001244193 2.852533 0.1
EOD
$m11 << EOD
0.1142694 0.00167454 16.66667
0.117715 0.003200697 8.333333
0.1174315 0.006736956 4
0.1173582 0.01331287 2
0.1173394 0.0264963 1
0.1173347 0.05349718 0.5
0.1173336 0.1067614 0.25
0.1173332 0.2665758 0.1
EOD
$m12 << EOD
0.04325229 0.0076587 16.66667
0.04816471 0.01626665 8.333333
0.06067908 0.03339363 4
0.06163425 0.06694394 2
0.06161525 0.1347003 1
0.06161022 0.2691163 0.5
0.06160895 0.5352856 0.25
0.0616086 1.315954 0.1
EOD
$rings << EOD
0.008810744 4.391669
0.0002900228 3.047562
0.0002900258 6.577653
0.0002900258 4.713278
0.0002900292 0.478805
0.0001488968 8.374667
0.0001489011 0.9335834
0.008810557 0.2094695
0.008810449 0.4748424
0.1173394 0.0264963
0.06161525 0.1347003
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
