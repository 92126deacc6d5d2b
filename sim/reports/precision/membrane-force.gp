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
0.001696586 0.01972702 3.333333
0.0013856 0.03212224 2
0.00117239 0.06405852 1
0.0001487323 0.1281859 0.5
3.186591e-05 0.2554383 0.25
EOD
$m1 << EOD
0.06293803 0.00888086 3.333333
0.0637731 0.01488979 2
0.06329333 0.02976283 1
0.0626311 0.05941856 0.5
0.0625801 0.1193169 0.25
EOD
$m2 << EOD
0.6800304 0.2484537 4
0.01732225 0.2808224 3.333333
0.008489924 0.3849897 2
0.003715003 0.68064 1
0.001999604 1.244621 0.5
0.001312368 2.469047 0.25
EOD
$m3 << EOD
0.001426954 0.2128487 4
0.002558379 0.2491337 3.333333
0.001372062 0.3713349 2
0.0009598642 0.7217854 1
0.0004024489 1.336635 0.5
6.509257e-05 2.666554 0.25
EOD
$m4 << EOD
0.001662405 0.8265615 4
0.002486772 0.8429552 3.333333
0.001359326 1.128353 2
0.0009595859 1.483014 1
0.000401086 2.801411 0.5
EOD
$m5 << EOD
0.001662405 2.282618 4
0.002486773 2.139331 3.333333
0.001359326 3.219748 2
0.0009595859 4.511236 1
EOD
$m6 << EOD
0.001476389 0.1254696 4
0.002585402 0.1470565 3.333333
0.001361187 0.2411784 2
0.0009596678 0.4846079 1
0.0004011227 1.002285 0.5
6.466597e-05 1.235309 0.25
EOD
$m7 << EOD
0.9866638 0.947039 8.333333
0.002533624 1.164086 4
0.001881325 1.293008 3.333333
0.0008958167 1.465017 2
0.0007772355 2.725792 1
EOD
$m8 << EOD
0.9864644 0.1217189 8.333333
0.002534719 0.2344159 4
0.00187979 0.2928273 3.333333
0.0008957624 0.4825058 2
0.0007772433 0.9806312 1
0.000138793 1.718925 0.5
2.678746e-05 2.300939 0.25
EOD
$m9 << EOD
0.5317735 0.0558015 4
0.01778617 0.0650063 3.333333
0.008939207 0.1043156 2
0.004000363 0.2118913 1
0.002143393 0.4196046 0.5
0.001375137 0.8619403 0.25
EOD
$m10 << EOD
0.5586118 0.1755111 4
0.01847213 0.204054 3.333333
0.009192508 0.333441 2
0.004063822 0.6326001 1
0.002158094 0.9827482 0.5
0.00137826 1.379879 0.25
EOD
$m11 << EOD
0.7103022 0.001661671 16.66667
0.7142119 0.003255899 8.333333
0.7152428 0.006713736 4
0.7153418 0.008036948 3.333333
0.7154877 0.0134124 2
0.71555 0.02671023 1
0.7155657 0.05355352 0.5
0.7155697 0.1073898 0.25
EOD
$m12 << EOD
0.1836647 0.008145689 16.66667
0.2478401 0.01557302 8.333333
0.2419729 0.03150384 4
0.2420189 0.0376291 3.333333
0.2422804 0.0635864 2
0.2424557 0.1375449 1
0.2425048 0.2616357 0.5
0.2425173 0.5299423 0.25
EOD
$rings << EOD
0.00117239 0.06405852
0.06329333 0.02976283
0.003715003 0.68064
0.0009598642 0.7217854
0.0009595859 1.483014
0.0009595859 4.511236
0.0009596678 0.4846079
0.0007772355 2.725792
0.0007772433 0.9806312
0.004000363 0.2118913
0.004063822 0.6326001
0.71555 0.02671023
0.2424557 0.1375449
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
