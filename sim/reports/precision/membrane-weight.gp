# SPDX-License-Identifier: Apache-2.0
# gnuplot -c membrane-weight.gp svg | png    makes membrane-weight.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 1100,680 font 'sans,11' }
else { set terminal svg size 1100,680 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'membrane-weight'.'.'.ARG1 }
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
1.01358e-05 0.0136885 16.6667
1.01358e-05 0.0144015 8.33333
5.25564e-06 0.0199397 4
3.65116e-06 0.0257315 3.33333
5.25564e-06 0.0211841 2
1.31511e-06 0.0413108 1
3.28789e-07 0.0840342 0.5
8.21915e-08 0.178712 0.25
EOD
$m1 << EOD
1.46002e-05 0.0129206 3.33333
5.25564e-06 0.0236164 2
1.31511e-06 0.0430494 1
3.28789e-07 0.0860958 0.5
8.21915e-08 0.17011 0.25
EOD
$m2 << EOD
0.044989 0.00882185 3.33333
0.0449879 0.0145624 2
0.0449875 0.0285111 1
0.0449874 0.0410699 0.5
0.0449873 0.084274 0.25
EOD
$m3 << EOD
0.0238032 0.210102 16.6667
0.0122589 0.259786 8.33333
0.00598969 0.318175 4
0.00500629 0.326441 3.33333
0.00302291 0.421575 2
0.0015203 0.783986 1
0.000762827 1.32721 0.5
0.000382685 2.50046 0.25
EOD
$m4 << EOD
0.000589761 0.121592 16.6667
0.000164229 0.145937 8.33333
4.01435e-05 0.256493 4
2.80631e-05 0.315269 3.33333
1.02071e-05 0.437583 2
2.56319e-06 0.916792 1
6.43208e-07 2.01285 0.5
EOD
$m5 << EOD
0.000608548 1.36595 16.6667
0.000168494 1.10441 8.33333
4.1078e-05 1.00461 4
2.87039e-05 1.02805 3.33333
1.04327e-05 1.40418 2
2.62376e-06 2.06708 1
EOD
$m6 << EOD
0.000608548 2.88949 16.6667
0.000168494 4.1991 8.33333
4.1078e-05 7.57278 4
2.87039e-05 6.60247 3.33333
1.04327e-05 9.27846 2
2.62376e-06 18.196 1
EOD
$m7 << EOD
0.000580765 0.0499801 16.6667
0.00016741 0.0833243 8.33333
4.10031e-05 0.178653 4
2.86664e-05 0.220301 3.33333
1.04277e-05 0.365485 2
2.62357e-06 0.740135 1
6.57142e-07 1.45626 0.5
1.64374e-07 2.93692 0.25
EOD
$m8 << EOD
0.000307323 1.38034 16.6667
8.40102e-05 1.49716 8.33333
2.00994e-05 1.73815 4
1.40115e-05 1.63501 3.33333
5.07813e-06 2.10053 2
1.27448e-06 2.96253 1
EOD
$m9 << EOD
0.000305629 0.0838875 16.6667
8.38992e-05 0.170817 8.33333
2.00918e-05 0.359293 4
1.40086e-05 0.535995 3.33333
5.07796e-06 0.790973 2
1.27447e-06 1.51205 1
3.18927e-07 2.94361 0.5
EOD
$m10 << EOD
0.00575587 0.0788795 4
0.00481958 0.0949964 3.33333
0.0029203 0.160682 2
0.00147159 0.319884 1
0.000738927 0.728007 0.5
0.000370318 1.29711 0.25
EOD
$m11 << EOD
0.0228117 0.0623805 16.6667
0.0118169 0.122525 8.33333
0.0057927 0.250664 4
0.0048444 0.300433 3.33333
0.00292863 0.502839 2
0.00147355 1.03368 1
0.000739399 2.09957 0.5
EOD
$m12 << EOD
0.0450629 0.00166673 16.6667
0.0450629 0.00350735 8.33333
0.0450629 0.00644992 4
0.0450629 0.00567216 3.33333
0.0450629 0.013946 2
0.0450629 0.0231206 1
0.0450629 0.0403946 0.5
0.0450629 0.0823258 0.25
EOD
$m13 << EOD
0.0449902 0.00699841 16.6667
0.0449902 0.0143168 8.33333
0.0449902 0.037258 4
0.0449902 0.0345992 3.33333
0.0449902 0.064936 2
0.0449902 0.117227 1
0.0449902 0.26359 0.5
0.0449902 0.477669 0.25
EOD
$rings << EOD
1.31511e-06 0.0413108
1.31511e-06 0.0430494
0.0449875 0.0285111
0.0015203 0.783986
2.56319e-06 0.916792
2.62376e-06 2.06708
2.62376e-06 18.196
2.62357e-06 0.740135
1.27448e-06 2.96253
1.27447e-06 1.51205
0.00147159 0.319884
0.00147355 1.03368
0.0450629 0.0231206
0.0449902 0.117227
EOD
set logscale xy
set format x '10^{%L}'
set format y '10^{%L}'
set mxtics 1
set mytics 1
set title 'membrane: E 10 kPa, load -sin^2(2 pi t) N at the centre; marks: h in ms, ringed: 1 ms' noenhanced
set xlabel 'relative error of displacements under a weight that is there at once (the reference is off by 3.3e-14)' noenhanced
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
