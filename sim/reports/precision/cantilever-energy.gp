# SPDX-License-Identifier: Apache-2.0
# gnuplot -c cantilever-energy.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 1100,680 font 'sans,11'; set output 'cantilever-energy.png' }
else { set terminal svg size 1100,680 font 'sans,13' background 'white'; set output 'cantilever-energy.svg' }
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
4.94382e-06 0.07359043 0.8333333
1.780778e-06 0.1225348 0.5
4.451965e-07 0.2448756 0.25
EOD
$m1 << EOD
0.003015426 0.03166476 0.8333333
0.003012614 0.0534827 0.5
0.003011425 0.1070352 0.25
EOD
$m2 << EOD
0.1464435 0.3396187 16.66667
0.07536432 0.3856827 8.333333
0.0366577 0.4449349 4
0.01843552 0.5449647 2
0.009244048 0.7777199 1
0.007706534 0.8753727 0.8333333
0.004628014 1.281405 0.5
0.002318042 2.330436 0.25
EOD
$m3 << EOD
0.002240566 0.2185572 16.66667
0.0005511368 0.2456993 8.333333
0.0001280455 0.3099702 4
3.201168e-05 0.4364232 2
8.006033e-06 0.7191861 1
5.559473e-06 0.8311834 0.8333333
2.007839e-06 1.299234 0.5
5.032174e-07 2.464361 0.25
EOD
$m4 << EOD
0.002253442 0.8280594 16.66667
0.0005539185 0.9131668 8.333333
0.0001286573 0.970766 4
3.216503e-05 1.128586 2
8.043454e-06 1.612109 1
5.585103e-06 1.828296 0.8333333
2.0154e-06 2.610188 0.5
EOD
$m5 << EOD
0.002253442 0.5410574 16.66667
0.0005539185 1.025494 8.333333
0.0001286573 1.841686 4
3.216503e-05 3.123694 2
8.043455e-06 5.258848 1
EOD
$m6 << EOD
0.002251947 0.02617585 16.66667
0.0005535382 0.05243061 8.333333
0.0001286504 0.1081647 4
3.216516e-05 0.2095616 2
8.043636e-06 0.4116676 1
5.596326e-06 0.499805 0.8333333
2.043709e-06 0.4994707 0.5
5.088756e-07 0.969512 0.25
EOD
$m7 << EOD
0.001507608 1.035785 16.66667
0.0003757785 1.095934 8.333333
8.658589e-05 1.22799 4
2.1623e-05 1.68531 2
5.408743e-06 2.634975 1
EOD
$m8 << EOD
0.001506237 0.04884399 16.66667
0.0003758506 0.09871001 8.333333
8.659455e-05 0.2038786 4
2.162335e-05 0.4095012 2
5.450785e-06 0.6089547 1
3.783716e-06 0.6300113 0.8333333
1.360125e-06 0.9400217 0.5
3.399422e-07 1.874596 0.25
EOD
$m9 << EOD
0.1513562 0.01051314 16.66667
0.07633937 0.02077637 8.333333
0.03686454 0.04346059 4
0.01852072 0.08678946 2
0.009290686 0.1864756 1
0.007747014 0.2137516 0.8333333
0.004654282 0.3628429 0.5
0.002329594 0.70376 0.25
EOD
$m10 << EOD
0.1471219 0.03463191 16.66667
0.07576101 0.06653354 8.333333
0.03686406 0.1329585 4
0.01854283 0.2245873 2
0.009299393 0.4059957 1
0.007753445 0.4772377 0.8333333
0.004656944 0.7527031 0.5
0.002330309 0.961756 0.25
EOD
$m11 << EOD
0.002153906 0.001183262 16.66667
0.002742372 0.002360304 8.333333
0.002897709 0.004778524 4
0.002932763 0.009731693 2
0.002941536 0.019269 1
0.00294243 0.02324368 0.8333333
0.00294373 0.0390682 0.5
0.002944278 0.07793111 0.25
EOD
$m12 << EOD
0.002208033 0.005702938 16.66667
0.002771094 0.0104745 8.333333
0.002928902 0.02315879 4
0.002964491 0.04558819 2
0.002973396 0.09154304 1
0.002974303 0.111138 0.8333333
0.002975623 0.1814578 0.5
0.00297618 0.3674396 0.25
EOD
$rings << EOD
0.009244048 0.7777199
8.006033e-06 0.7191861
8.043454e-06 1.612109
8.043455e-06 5.258848
8.043636e-06 0.4116676
5.408743e-06 2.634975
5.450785e-06 0.6089547
0.009290686 0.1864756
0.009299393 0.4059957
0.002941536 0.019269
0.002973396 0.09154304
EOD
set logscale xy
set format x '10^{%L}'
set format y '10^{%L}'
set mxtics 1
set mytics 1
set title "cantilever: E 1 MPa, load -40 sin^2(2 pi t) N on the tip; marks: h in ms, ringed: 1 ms" noenhanced
set xlabel 'relative error of energy (the reference is off by 1.8e-10)'
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
