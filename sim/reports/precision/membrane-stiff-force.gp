# SPDX-License-Identifier: Apache-2.0
# gnuplot -c membrane-stiff-force.gp svg | png    makes membrane-stiff-force.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 1100,680 font 'sans,11' }
else { set terminal svg size 1100,680 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'membrane-stiff-force'.'.'.ARG1 }
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
0.000228166 0.0886015 16.6667
8.95859e-05 0.168331 8.33333
2.16814e-05 0.271523 4
3.83062e-06 0.403505 2
8.37401e-07 0.410915 1
1.50959e-07 0.445325 0.5
4.15401e-08 0.472265 0.25
6.65297e-09 0.794689 0.1
EOD
$m1 << EOD
2.6788e-08 0.398581 0.1
EOD
$m2 << EOD
8.94333e-06 0.200843 0.1
EOD
$m3 << EOD
0.000223202 1.50682 16.6667
0.00022854 2.62999 8.33333
0.000223232 3.73084 4
0.000189403 4.61001 2
0.000135154 6.35047 1
EOD
$m4 << EOD
0.000696334 1.22281 16.6667
9.23672e-05 2.09292 8.33333
4.44581e-05 2.59576 4
1.02747e-05 2.81338 2
3.08669e-06 3.9119 1
EOD
$m5 << EOD
0.000747702 3.63295 16.6667
0.000107168 5.27921 8.33333
4.44595e-05 5.85931 4
1.02747e-05 6.52686 2
3.08677e-06 6.24166 1
EOD
$m6 << EOD
0.000747702 0.886571 16.6667
0.000107168 1.74434 8.33333
4.44595e-05 3.36246 4
1.02747e-05 5.84281 2
3.08677e-06 10.7278 1
EOD
$m7 << EOD
0.00074799 0.0460511 16.6667
0.000107276 0.0953288 8.33333
4.44594e-05 0.196448 4
1.02755e-05 0.341313 2
3.08678e-06 0.684314 1
9.6734e-07 1.36444 0.5
2.74492e-07 2.72531 0.25
EOD
$m8 << EOD
0.000228175 5.52451 16.6667
8.95556e-05 6.70847 8.33333
2.16834e-05 8.37895 4
3.82529e-06 10.9004 2
1.59513e-06 10.7058 1
EOD
$m9 << EOD
0.000228165 0.0813161 16.6667
8.95597e-05 0.162924 8.33333
2.1688e-05 0.340975 4
3.82694e-06 0.690932 2
1.59532e-06 1.37298 1
4.4969e-07 2.83883 0.5
EOD
$m10 << EOD
0.000223261 0.019207 16.6667
0.000228615 0.0380155 8.33333
0.000223273 0.079124 4
0.000189424 0.158859 2
0.000135165 0.316688 1
8.35598e-05 0.642698 0.5
4.71217e-05 1.28591 0.25
2.05203e-05 3.24233 0.1
EOD
$m11 << EOD
0.000223356 0.0594465 16.6667
0.000228626 0.116656 8.33333
0.000223275 0.230949 4
0.000189424 0.438796 2
0.000135165 0.745146 1
8.35597e-05 1.37189 0.5
4.71217e-05 2.89232 0.25
EOD
$m12 << EOD
0.0103634 0.00116607 16.6667
0.010451 0.00240343 8.33333
0.0104589 0.00553162 4
0.01046 0.00975164 2
0.0104602 0.019602 1
0.0104603 0.0384463 0.5
0.0104603 0.0782485 0.25
0.0104603 0.20824 0.1
EOD
$m13 << EOD
0.0053554 0.00705738 16.6667
0.00552962 0.0141398 8.33333
0.0054565 0.0292829 4
0.00546444 0.0591192 2
0.00546516 0.117768 1
0.00546526 0.233851 0.5
0.00546527 0.494373 0.25
0.00546528 1.18102 0.1
EOD
$rings << EOD
8.37401e-07 0.410915
0.000135154 6.35047
3.08669e-06 3.9119
3.08677e-06 6.24166
3.08677e-06 10.7278
3.08678e-06 0.684314
1.59513e-06 10.7058
1.59532e-06 1.37298
0.000135165 0.316688
0.000135165 0.745146
0.0104602 0.019602
0.00546516 0.117768
EOD
set logscale xy
set format x '10^{%L}'
set format y '10^{%L}'
set mxtics 1
set mytics 1
set title 'stiff membrane: E 10 MPa, load -sin^2(2 pi t) N at the centre; marks: h in ms, ringed: 1 ms' noenhanced
set xlabel 'relative error of the force at the probe (the reference is off by 8.0e-14)' noenhanced
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
