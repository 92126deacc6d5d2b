# SPDX-License-Identifier: Apache-2.0
# gnuplot -c membrane-stiff-displacement.gp svg | png    makes membrane-stiff-displacement.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 1100,680 font 'sans,11' }
else { set terminal svg size 1100,680 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'membrane-stiff-displacement'.'.'.ARG1 }
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
0.0187352 0.0886015 16.6667
0.00499207 0.168331 8.33333
0.00128833 0.271523 4
0.00036323 0.403505 2
8.8189e-05 0.410915 1
3.57245e-06 0.445325 0.5
9.76685e-07 0.472265 0.25
2.9182e-07 0.794689 0.1
EOD
$m1 << EOD
1.01676e-06 0.398581 0.1
EOD
$m2 << EOD
0.000144471 0.200843 0.1
EOD
$m3 << EOD
0.0223223 1.50682 16.6667
0.0196824 2.62999 8.33333
0.0179329 3.73084 4
0.0151532 4.61001 2
0.0108924 6.35047 1
EOD
$m4 << EOD
0.0417436 1.22281 16.6667
0.00982984 2.09292 8.33333
0.00265428 2.59576 4
0.000696327 2.81338 2
0.000187914 3.9119 1
EOD
$m5 << EOD
0.0417435 3.63295 16.6667
0.0098298 5.27921 8.33333
0.00265426 5.85931 4
0.000696326 6.52686 2
0.000187911 6.24166 1
EOD
$m6 << EOD
0.0417435 0.886571 16.6667
0.0098298 1.74434 8.33333
0.00265426 3.36246 4
0.000696326 5.84281 2
0.000187911 10.7278 1
EOD
$m7 << EOD
0.0417453 0.0460511 16.6667
0.00982977 0.0953288 8.33333
0.0026543 0.196448 4
0.000696326 0.341313 2
0.000187914 0.684314 1
4.57308e-05 1.36444 0.5
1.15399e-05 2.72531 0.25
EOD
$m8 << EOD
0.018734 5.52451 16.6667
0.00499214 6.70847 8.33333
0.0012879 8.37895 4
0.00035343 10.9004 2
8.6977e-05 10.7058 1
EOD
$m9 << EOD
0.0187352 0.0813161 16.6667
0.00499232 0.162924 8.33333
0.00128797 0.340975 4
0.000353445 0.690932 2
8.69809e-05 1.37298 1
2.16198e-05 2.83883 0.5
EOD
$m10 << EOD
0.022324 0.019207 16.6667
0.0196827 0.0380155 8.33333
0.017933 0.079124 4
0.0151532 0.158859 2
0.0108924 0.316688 1
0.00676235 0.642698 0.5
0.00380583 1.28591 0.25
0.00163905 3.24233 0.1
EOD
$m11 << EOD
0.0223216 0.0594465 16.6667
0.0196821 0.116656 8.33333
0.0179328 0.230949 4
0.0151531 0.438796 2
0.0108923 0.745146 1
0.00676235 1.37189 0.5
0.00380583 2.89232 0.25
EOD
$m12 << EOD
0.0210732 0.00116607 16.6667
0.0205385 0.00240343 8.33333
0.0205322 0.00553162 4
0.0205316 0.00975164 2
0.0205315 0.019602 1
0.0205315 0.0384463 0.5
0.0205315 0.0782485 0.25
0.0205315 0.20824 0.1
EOD
$m13 << EOD
0.0119865 0.00705738 16.6667
0.0105366 0.0141398 8.33333
0.00613657 0.0292829 4
0.00600389 0.0591192 2
0.00600382 0.117768 1
0.00600382 0.233851 0.5
0.00600381 0.494373 0.25
0.00600381 1.18102 0.1
EOD
$rings << EOD
8.8189e-05 0.410915
0.0108924 6.35047
0.000187914 3.9119
0.000187911 6.24166
0.000187911 10.7278
0.000187914 0.684314
8.6977e-05 10.7058
8.69809e-05 1.37298
0.0108924 0.316688
0.0108923 0.745146
0.0205315 0.019602
0.00600382 0.117768
EOD
set logscale xy
set format x '10^{%L}'
set format y '10^{%L}'
set mxtics 1
set mytics 1
set title 'stiff membrane: E 10 MPa, load -sin^2(2 pi t) N at the centre; marks: h in ms, ringed: 1 ms' noenhanced
set xlabel 'relative error of displacements (the reference is off by 4.9e-12)' noenhanced
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
