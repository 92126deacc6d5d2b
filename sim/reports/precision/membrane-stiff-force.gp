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
2.853399e-08 0.6085704 0.1
EOD
$m1 << EOD
8.944591e-06 0.2974309 0.1
EOD
$m2 << EOD
0.0002232021 1.186338 16.66667
0.00022854 2.333974 8.333333
0.0002232321 3.6361 4
0.0001894027 4.24809 2
0.0001351542 4.391669 1
EOD
$m3 << EOD
0.0006963342 1.232804 16.66667
9.236716e-05 1.865245 8.333333
4.445813e-05 2.586963 4
1.027469e-05 2.886795 2
3.086696e-06 3.047562 1
EOD
$m4 << EOD
0.000747702 3.461695 16.66667
0.000107167 4.481176 8.333333
4.445952e-05 5.031618 4
1.02747e-05 5.826037 2
3.086778e-06 6.577653 1
EOD
$m5 << EOD
0.000747702 0.4150622 16.66667
0.000107167 0.7482359 8.333333
4.445952e-05 1.312627 4
1.02747e-05 2.571289 2
3.086778e-06 4.713278 1
EOD
$m6 << EOD
0.0007480568 0.02926095 16.66667
0.0001073066 0.0586122 8.333333
4.445946e-05 0.123351 4
1.027472e-05 0.2437354 2
3.086782e-06 0.478805 1
9.673666e-07 0.9504584 0.5
2.745008e-07 1.328617 0.25
4.500909e-08 2.872133 0.1
EOD
$m7 << EOD
0.000228175 5.66395 16.66667
8.955559e-05 6.825862 8.333333
2.16834e-05 7.852018 4
3.825299e-06 8.221824 2
1.595136e-06 8.374667 1
EOD
$m8 << EOD
0.0002281887 0.05679599 16.66667
8.956318e-05 0.1201478 8.333333
2.168776e-05 0.2326772 4
3.826323e-06 0.4659605 2
1.595257e-06 0.9335834 1
4.496996e-07 1.868111 0.5
1.356659e-07 3.414696 0.25
EOD
$m9 << EOD
0.0002232607 0.01285637 16.66667
0.0002286146 0.02553422 8.333333
0.0002232733 0.0520823 4
0.0001894235 0.1055687 2
0.0001351649 0.2094695 1
8.355975e-05 0.4150833 0.5
4.712169e-05 0.8214589 0.25
2.05203e-05 2.092804 0.1
EOD
$m10 << EOD
0.0002233563 0.03979728 16.66667
0.000228626 0.06289032 8.333333
0.0002232748 0.1244818 4
0.0001894239 0.2410381 2
0.0001351649 0.4748424 1
8.355971e-05 0.9404242 0.5
4.712166e-05 1.266607 0.25
2.05203e-05 2.852533 0.1
EOD
$m11 << EOD
0.01036343 0.00167454 16.66667
0.01045096 0.003200697 8.333333
0.01045885 0.006736956 4
0.01046 0.01331287 2
0.01046024 0.0264963 1
0.01046029 0.05349718 0.5
0.0104603 0.1067614 0.25
0.0104603 0.2665758 0.1
EOD
$m12 << EOD
0.005355401 0.0076587 16.66667
0.005529616 0.01626665 8.333333
0.005456502 0.03339363 4
0.005464439 0.06694394 2
0.005465156 0.1347003 1
0.005465257 0.2691163 0.5
0.005465274 0.5352856 0.25
0.005465278 1.315954 0.1
EOD
$rings << EOD
0.0001351542 4.391669
3.086696e-06 3.047562
3.086778e-06 6.577653
3.086778e-06 4.713278
3.086782e-06 0.478805
1.595136e-06 8.374667
1.595257e-06 0.9335834
0.0001351649 0.2094695
0.0001351649 0.4748424
0.01046024 0.0264963
0.005465156 0.1347003
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
