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
6.037731e-05 0.01972702 3.333333
2.196867e-05 0.03212224 2
5.480542e-06 0.06405852 1
1.374778e-06 0.1281859 0.5
3.439172e-07 0.2554383 0.25
EOD
$m1 << EOD
0.05486527 0.00888086 3.333333
0.05485443 0.01488979 2
0.05484985 0.02976283 1
0.05484875 0.05941856 0.5
0.05484846 0.1193169 0.25
EOD
$m2 << EOD
0.1412767 0.1647246 16.66667
0.08106338 0.1869259 8.333333
0.04227455 0.2484537 4
0.0357317 0.2808224 3.333333
0.02209612 0.3849897 2
0.01131945 0.68064 1
0.005738535 1.244621 0.5
0.002889495 2.469047 0.25
EOD
$m3 << EOD
0.001710772 0.1041768 16.66667
0.0004729128 0.1358606 8.333333
0.0001148839 0.2128487 4
7.981159e-05 0.2491337 3.333333
2.878301e-05 0.3713349 2
7.204989e-06 0.7217854 1
1.806092e-06 1.336635 0.5
4.499183e-07 2.666554 0.25
EOD
$m4 << EOD
0.001854448 0.7659726 16.66667
0.0004878812 0.7059354 8.333333
0.0001164654 0.8265615 4
8.075566e-05 0.8429552 3.333333
2.894041e-05 1.128353 2
7.204263e-06 1.483014 1
1.797779e-06 2.801411 0.5
EOD
$m5 << EOD
0.001854448 1.180124 16.66667
0.0004878812 1.63703 8.333333
0.0001164654 2.282618 4
8.075566e-05 2.139331 3.333333
2.894041e-05 3.219748 2
7.204263e-06 4.511236 1
EOD
$m6 << EOD
0.0548073 0.03368378 16.66667
0.001805151 0.0641048 8.333333
8.269451e-05 0.1254696 4
6.647718e-05 0.1470565 3.333333
3.061957e-05 0.2411784 2
7.102675e-06 0.4846079 1
1.798459e-06 1.002285 0.5
4.712334e-07 1.235309 0.25
EOD
$m7 << EOD
0.001613846 1.002639 16.66667
0.0004080281 0.947039 8.333333
9.362988e-05 1.164086 4
6.476949e-05 1.293008 3.333333
2.310477e-05 1.465017 2
5.756297e-06 2.725792 1
EOD
$m8 << EOD
0.009600907 0.06158087 16.66667
0.0004244782 0.1217189 8.333333
7.890557e-05 0.2344159 4
4.767225e-05 0.2928273 3.333333
2.191137e-05 0.4825058 2
5.717869e-06 0.9806312 1
1.473239e-06 1.718925 0.5
3.092785e-07 2.300939 0.25
EOD
$m9 << EOD
0.05156662 0.0558015 4
0.03612202 0.0650063 3.333333
0.02373594 0.1043156 2
0.01271252 0.2118913 1
0.006584295 0.4196046 0.5
0.003352321 0.8619403 0.25
EOD
$m10 << EOD
0.1162542 0.04496096 16.66667
0.09029522 0.08576562 8.333333
0.04940281 0.1755111 4
0.04194197 0.204054 3.333333
0.02592611 0.333441 2
0.01328348 0.6326001 1
0.006730287 0.9827482 0.5
0.003389332 1.379879 0.25
EOD
$m11 << EOD
0.2031111 0.001661671 16.66667
0.2031041 0.003255899 8.333333
0.2031027 0.006713736 4
0.2031026 0.008036948 3.333333
0.2031024 0.0134124 2
0.2031023 0.02671023 1
0.2031023 0.05355352 0.5
0.2031023 0.1073898 0.25
EOD
$m12 << EOD
0.1022518 0.008145689 16.66667
0.1022348 0.01557302 8.333333
0.1022305 0.03150384 4
0.1022301 0.0376291 3.333333
0.1022296 0.0635864 2
0.1022293 0.1375449 1
0.1022293 0.2616357 0.5
0.1022293 0.5299423 0.25
EOD
$rings << EOD
5.480542e-06 0.06405852
0.05484985 0.02976283
0.01131945 0.68064
7.204989e-06 0.7217854
7.204263e-06 1.483014
7.204263e-06 4.511236
7.102675e-06 0.4846079
5.756297e-06 2.725792
5.717869e-06 0.9806312
0.01271252 0.2118913
0.01328348 0.6326001
0.2031023 0.02671023
0.1022293 0.1375449
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
