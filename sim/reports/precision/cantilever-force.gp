# SPDX-License-Identifier: Apache-2.0
# gnuplot -c cantilever-force.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 1100,680 font 'sans,11'; set output 'cantilever-force.png' }
else { set terminal svg size 1100,680 font 'sans,13' background 'white'; set output 'cantilever-force.svg' }
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
3.550735e-06 0.07359043 0.8333333
1.281585e-06 0.1225348 0.5
3.20408e-07 0.2448756 0.25
EOD
$m1 << EOD
0.0006717778 0.03166476 0.8333333
0.0006698644 0.0534827 0.5
0.0006690587 0.1070352 0.25
EOD
$m2 << EOD
0.1004604 0.3396187 16.66667
0.05297682 0.3856827 8.333333
0.02627713 0.4449349 4
0.01338359 0.5449647 2
0.006765668 0.7777199 1
0.005649425 0.8753727 0.8333333
0.003403918 1.281405 0.5
0.00170663 2.330436 0.25
EOD
$m3 << EOD
0.0009209135 0.2185572 16.66667
0.0002287904 0.2456993 8.333333
4.834539e-05 0.3099702 4
1.177334e-05 0.4364232 2
2.960469e-06 0.7191861 1
2.068569e-06 0.8311834 0.8333333
7.704262e-07 1.299234 0.5
1.982798e-07 2.464361 0.25
EOD
$m4 << EOD
0.0009210371 0.8280594 16.66667
0.0002288091 0.9131668 8.333333
4.835298e-05 0.970766 4
1.177836e-05 1.128586 2
2.96287e-06 1.612109 1
2.070279e-06 1.828296 0.8333333
7.700122e-07 2.610188 0.5
EOD
$m5 << EOD
0.0009210371 0.5410574 16.66667
0.0002288091 1.025494 8.333333
4.835298e-05 1.841686 4
1.177836e-05 3.123694 2
2.962873e-06 5.258848 1
EOD
$m6 << EOD
0.0009206497 0.02617585 16.66667
0.0002287897 0.05243061 8.333333
4.835226e-05 0.1081647 4
1.177845e-05 0.2095616 2
2.967603e-06 0.4116676 1
2.075508e-06 0.499805 0.8333333
7.709588e-07 0.4994707 0.5
1.981369e-07 0.969512 0.25
EOD
$m7 << EOD
0.001080358 1.035785 16.66667
0.000252711 1.095934 8.333333
5.328589e-05 1.22799 4
1.26785e-05 1.68531 2
3.112881e-06 2.634975 1
EOD
$m8 << EOD
0.001080433 0.04884399 16.66667
0.0002527142 0.09871001 8.333333
5.328629e-05 0.2038786 4
1.267846e-05 0.4095012 2
3.11547e-06 0.6089547 1
2.159942e-06 0.6300113 0.8333333
7.793018e-07 0.9400217 0.5
1.944253e-07 1.874596 0.25
EOD
$m9 << EOD
0.1006742 0.01051314 16.66667
0.05302102 0.02077637 8.333333
0.02628686 0.04346059 4
0.01338822 0.08678946 2
0.006768367 0.1864756 1
0.005651758 0.2137516 0.8333333
0.003405567 0.3628429 0.5
0.001708602 0.70376 0.25
EOD
$m10 << EOD
0.1004956 0.03463191 16.66667
0.05299797 0.06653354 8.333333
0.02628852 0.1329585 4
0.01338974 0.2245873 2
0.006768905 0.4059957 1
0.005652156 0.4772377 0.8333333
0.003405727 0.7527031 0.5
0.001708644 0.961756 0.25
EOD
$m11 << EOD
0.0008373491 0.001183262 16.66667
0.001017275 0.002360304 8.333333
0.001185206 0.004778524 4
0.001224843 0.009731693 2
0.001234764 0.019269 1
0.001235772 0.02324368 0.8333333
0.001237237 0.0390682 0.5
0.001237854 0.07793111 0.25
EOD
$m12 << EOD
0.001024144 0.005702938 16.66667
0.0006742371 0.0104745 8.333333
0.0007939367 0.02315879 4
0.0008266912 0.04558819 2
0.0008349511 0.09154304 1
0.0008357888 0.111138 0.8333333
0.000837004 0.1814578 0.5
0.0008375146 0.3674396 0.25
EOD
$rings << EOD
0.006765668 0.7777199
2.960469e-06 0.7191861
2.96287e-06 1.612109
2.962873e-06 5.258848
2.967603e-06 0.4116676
3.112881e-06 2.634975
3.11547e-06 0.6089547
0.006768367 0.1864756
0.006768905 0.4059957
0.001234764 0.019269
0.0008349511 0.09154304
EOD
set logscale xy
set format x '10^{%L}'
set format y '10^{%L}'
set mxtics 1
set mytics 1
set title "cantilever: E 1 MPa, load -40 sin^2(2 pi t) N on the tip; marks: h in ms, ringed: 1 ms" noenhanced
set xlabel 'relative error of the force at the probe (the reference is off by 1.3e-10)'
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
