# SPDX-License-Identifier: Apache-2.0
# gnuplot -c cantilever-displacement.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 1100,680 font 'sans,11'; set output 'cantilever-displacement.png' }
else { set terminal svg size 1100,680 font 'sans,13' background 'white'; set output 'cantilever-displacement.svg' }
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
3.511407e-06 0.07359043 0.8333333
1.26434e-06 0.1225348 0.5
3.160075e-07 0.2448756 0.25
EOD
$m1 << EOD
0.05314096 0.03166476 0.8333333
0.05314083 0.0534827 0.5
0.05314078 0.1070352 0.25
EOD
$m2 << EOD
0.0924356 0.3396187 16.66667
0.04682041 0.3856827 8.333333
0.0225993 0.4449349 4
0.01133018 0.5449647 2
0.00567367 0.7777199 1
0.004729177 0.8753727 0.8333333
0.002838927 1.281405 0.5
0.001420791 2.330436 0.25
EOD
$m3 << EOD
0.00153608 0.2185572 16.66667
0.0003839056 0.2456993 8.333333
8.859358e-05 0.3099702 4
2.217461e-05 0.4364232 2
5.547608e-06 0.7191861 1
3.853723e-06 0.8311834 0.8333333
1.390622e-06 1.299234 0.5
3.485216e-07 2.464361 0.25
EOD
$m4 << EOD
0.001542072 0.8280594 16.66667
0.0003852403 0.9131668 8.333333
8.88879e-05 0.970766 4
2.22459e-05 1.128586 2
5.564717e-06 1.612109 1
3.865532e-06 1.828296 0.8333333
1.395399e-06 2.610188 0.5
EOD
$m5 << EOD
0.001542072 0.5410574 16.66667
0.0003852403 1.025494 8.333333
8.888791e-05 1.841686 4
2.22459e-05 3.123694 2
5.564717e-06 5.258848 1
EOD
$m6 << EOD
0.001543145 0.02617585 16.66667
0.0003851555 0.05243061 8.333333
8.888621e-05 0.1081647 4
2.224564e-05 0.2095616 2
5.564785e-06 0.4116676 1
3.870084e-06 0.499805 0.8333333
1.406341e-06 0.4994707 0.5
3.513608e-07 0.969512 0.25
EOD
$m7 << EOD
0.0009424357 1.035785 16.66667
0.0002354453 1.095934 8.333333
5.414064e-05 1.22799 4
1.352467e-05 1.68531 2
3.383044e-06 2.634975 1
EOD
$m8 << EOD
0.0009417109 0.04884399 16.66667
0.0002354599 0.09871001 8.333333
5.414338e-05 0.2038786 4
1.352486e-05 0.4095012 2
3.400985e-06 0.6089547 1
2.361654e-06 0.6300113 0.8333333
8.505016e-07 0.9400217 0.5
2.127317e-07 1.874596 0.25
EOD
$m9 << EOD
0.09397181 0.01051314 16.66667
0.04715374 0.02077637 8.333333
0.02267206 0.04346059 4
0.01136144 0.08678946 2
0.005691319 0.1864756 1
0.004744554 0.2137516 0.8333333
0.002849071 0.3628429 0.5
0.001425505 0.70376 0.25
EOD
$m10 << EOD
0.09272232 0.03463191 16.66667
0.0469814 0.06653354 8.333333
0.02268096 0.1329585 4
0.01137215 0.2245873 2
0.005695209 0.4059957 1
0.0047474 0.4772377 0.8333333
0.00285023 0.7527031 0.5
0.001425813 0.961756 0.25
EOD
$m11 << EOD
0.0531165 0.001183262 16.66667
0.05313591 0.002360304 8.333333
0.05314136 0.004778524 4
0.05314261 0.009731693 2
0.05314292 0.019269 1
0.05314295 0.02324368 0.8333333
0.053143 0.0390682 0.5
0.05314302 0.07793111 0.25
EOD
$m12 << EOD
0.05311466 0.005702938 16.66667
0.0531339 0.0104745 8.333333
0.05313932 0.02315879 4
0.05314056 0.04558819 2
0.05314087 0.09154304 1
0.0531409 0.111138 0.8333333
0.05314095 0.1814578 0.5
0.05314097 0.3674396 0.25
EOD
$rings << EOD
0.00567367 0.7777199
5.547608e-06 0.7191861
5.564717e-06 1.612109
5.564717e-06 5.258848
5.564785e-06 0.4116676
3.383044e-06 2.634975
3.400985e-06 0.6089547
0.005691319 0.1864756
0.005695209 0.4059957
0.05314292 0.019269
0.05314087 0.09154304
EOD
set logscale xy
set format x '10^{%L}'
set format y '10^{%L}'
set mxtics 1
set mytics 1
set title "cantilever: E 1 MPa, load -40 sin^2(2 pi t) N on the tip; marks: h in ms, ringed: 1 ms" noenhanced
set xlabel 'relative error of displacements (the reference is off by 1.3e-10)'
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
