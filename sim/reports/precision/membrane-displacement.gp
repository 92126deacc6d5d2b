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
8.825574e-05 0.01972702 3.333333
3.17778e-05 0.03212224 2
7.953209e-06 0.06405852 1
1.988766e-06 0.1281859 0.5
4.969984e-07 0.2554383 0.25
EOD
$m1 << EOD
0.203209 0.00888086 3.333333
0.2032072 0.01488979 2
0.2032064 0.02976283 1
0.2032062 0.05941856 0.5
0.2032061 0.1193169 0.25
EOD
$m2 << EOD
0.09785283 0.1647246 16.66667
0.05201852 0.1869259 8.333333
0.02598859 0.2484537 4
0.02180816 0.2808224 3.333333
0.01327982 0.3849897 2
0.006725632 0.68064 1
0.003389457 1.244621 0.5
0.001699874 2.469047 0.25
EOD
$m3 << EOD
0.003780709 0.1041768 16.66667
0.0009863745 0.1358606 8.333333
0.0002351262 0.2128487 4
0.0001641902 0.2491337 3.333333
5.956314e-05 0.3713349 2
1.493261e-05 0.7217854 1
3.739675e-06 1.336635 0.5
9.352668e-07 2.666554 0.25
EOD
$m4 << EOD
0.003973406 0.7659726 16.66667
0.001033817 0.7059354 8.333333
0.0002459426 0.8265615 4
0.0001716835 0.8429552 3.333333
6.225527e-05 1.128353 2
1.560952e-05 1.483014 1
3.908342e-06 2.801411 0.5
EOD
$m5 << EOD
0.003973406 1.180124 16.66667
0.001033817 1.63703 8.333333
0.0002459426 2.282618 4
0.0001716835 2.139331 3.333333
6.225527e-05 3.219748 2
1.560952e-05 4.511236 1
EOD
$m6 << EOD
0.05024041 0.03368378 16.66667
0.001715423 0.0641048 8.333333
0.0002432001 0.1254696 4
0.0001707015 0.1470565 3.333333
6.223689e-05 0.2411784 2
1.559645e-05 0.4846079 1
3.90799e-06 1.002285 0.5
9.775817e-07 1.235309 0.25
EOD
$m7 << EOD
0.001948554 1.002639 16.66667
0.0005054047 0.947039 8.333333
0.0001195555 1.164086 4
8.326743e-05 1.293008 3.333333
3.009451e-05 1.465017 2
7.540389e-06 2.725792 1
EOD
$m8 << EOD
0.01100651 0.06158087 16.66667
0.0007450114 0.1217189 8.333333
0.0001158523 0.2344159 4
8.073e-05 0.2928273 3.333333
2.988929e-05 0.4825058 2
7.537804e-06 0.9806312 1
1.890922e-06 1.718925 0.5
4.74059e-07 2.300939 0.25
EOD
$m9 << EOD
0.0304818 0.0558015 4
0.02254652 0.0650063 3.333333
0.0136578 0.1043156 2
0.0069536 0.2118913 1
0.003523536 0.4196046 0.5
0.001775815 0.8619403 0.25
EOD
$m10 << EOD
0.1110801 0.04496096 16.66667
0.05416766 0.08576562 8.333333
0.02717614 0.1755111 4
0.02280192 0.204054 3.333333
0.01391907 0.333441 2
0.007055054 0.6326001 1
0.003553826 0.9827482 0.5
0.001784086 1.379879 0.25
EOD
$m11 << EOD
0.2174503 0.001661671 16.66667
0.2176199 0.003255899 8.333333
0.2176634 0.006713736 4
0.2176674 0.008036948 3.333333
0.2176732 0.0134124 2
0.2176756 0.02671023 1
0.2176763 0.05355352 0.5
0.2176764 0.1073898 0.25
EOD
$m12 << EOD
0.2043501 0.008145689 16.66667
0.2045331 0.01557302 8.333333
0.2045801 0.03150384 4
0.2045844 0.0376291 3.333333
0.2045906 0.0635864 2
0.2045933 0.1375449 1
0.2045939 0.2616357 0.5
0.2045941 0.5299423 0.25
EOD
$rings << EOD
7.953209e-06 0.06405852
0.2032064 0.02976283
0.006725632 0.68064
1.493261e-05 0.7217854
1.560952e-05 1.483014
1.560952e-05 4.511236
1.559645e-05 0.4846079
7.540389e-06 2.725792
7.537804e-06 0.9806312
0.0069536 0.2118913
0.007055054 0.6326001
0.2176756 0.02671023
0.2045933 0.1375449
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
