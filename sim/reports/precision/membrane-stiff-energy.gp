# SPDX-License-Identifier: Apache-2.0
# gnuplot -c membrane-stiff-energy.gp svg | png    makes membrane-stiff-energy.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 1100,680 font 'sans,11' }
else { set terminal svg size 1100,680 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'membrane-stiff-energy'.'.'.ARG1 }
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
0.0300001 0.0886015 16.6667
0.00769787 0.168331 8.33333
0.00172286 0.271523 4
0.000606368 0.403505 2
6.87554e-05 0.410915 1
2.23393e-06 0.445325 0.5
1.64629e-06 0.472265 0.25
4.99416e-07 0.794689 0.1
EOD
$m1 << EOD
1.65062e-06 0.398581 0.1
EOD
$m2 << EOD
0.000110469 0.200843 0.1
EOD
$m3 << EOD
0.0179538 1.50682 16.6667
0.0164249 2.62999 8.33333
0.0155046 3.73084 4
0.012855 4.61001 2
0.00881074 6.35047 1
EOD
$m4 << EOD
0.0508398 1.22281 16.6667
0.014548 2.09292 8.33333
0.00314261 2.59576 4
0.000864711 2.81338 2
0.000290022 3.9119 1
EOD
$m5 << EOD
0.0509027 3.63295 16.6667
0.0145466 5.27921 8.33333
0.00314245 5.85931 4
0.000864709 6.52686 2
0.000290025 6.24166 1
EOD
$m6 << EOD
0.0509027 0.886571 16.6667
0.0145466 1.74434 8.33333
0.00314245 3.36246 4
0.000864709 5.84281 2
0.000290025 10.7278 1
EOD
$m7 << EOD
0.0509047 0.0460511 16.6667
0.0145465 0.0953288 8.33333
0.00314254 0.196448 4
0.000864709 0.341313 2
0.000290029 0.684314 1
7.45e-05 1.36444 0.5
2.02092e-05 2.72531 0.25
EOD
$m8 << EOD
0.0299989 5.52451 16.6667
0.00769759 6.70847 8.33333
0.00171421 8.37895 4
0.000575699 10.9004 2
0.000148896 10.7058 1
EOD
$m9 << EOD
0.0300005 0.0813161 16.6667
0.00769798 0.162924 8.33333
0.00171436 0.340975 4
0.000575736 0.690932 2
0.000148904 1.37298 1
3.83464e-05 2.83883 0.5
EOD
$m10 << EOD
0.0179613 0.019207 16.6667
0.0164258 0.0380155 8.33333
0.0155045 0.079124 4
0.0128547 0.158859 2
0.00881056 0.316688 1
0.00525363 0.642698 0.5
0.00289564 1.28591 0.25
0.00124419 3.24233 0.1
EOD
$m11 << EOD
0.0179488 0.0594465 16.6667
0.0164225 0.116656 8.33333
0.0155036 0.230949 4
0.0128544 0.438796 2
0.00881045 0.745146 1
0.0052536 1.37189 0.5
0.00289563 2.89232 0.25
EOD
$m12 << EOD
0.114269 0.00116607 16.6667
0.117715 0.00240343 8.33333
0.117431 0.00553162 4
0.117358 0.00975164 2
0.117339 0.019602 1
0.117335 0.0384463 0.5
0.117334 0.0782485 0.25
0.117333 0.20824 0.1
EOD
$m13 << EOD
0.0432523 0.00705738 16.6667
0.0481647 0.0141398 8.33333
0.0606791 0.0292829 4
0.0616343 0.0591192 2
0.0616153 0.117768 1
0.0616102 0.233851 0.5
0.061609 0.494373 0.25
0.0616086 1.18102 0.1
EOD
$rings << EOD
6.87554e-05 0.410915
0.00881074 6.35047
0.000290022 3.9119
0.000290025 6.24166
0.000290025 10.7278
0.000290029 0.684314
0.000148896 10.7058
0.000148904 1.37298
0.00881056 0.316688
0.00881045 0.745146
0.117339 0.019602
0.0616153 0.117768
EOD
set logscale xy
set format x '10^{%L}'
set format y '10^{%L}'
set mxtics 1
set mytics 1
set title 'stiff membrane: E 10 MPa, load -sin^2(2 pi t) N at the centre; marks: h in ms, ringed: 1 ms' noenhanced
set xlabel 'relative error of energy (the reference is off by 6.9e-12)' noenhanced
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
