# SPDX-License-Identifier: Apache-2.0
# gnuplot -c cantilever-weight.gp svg | png    makes cantilever-weight.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 1100,680 font 'sans,11' }
else { set terminal svg size 1100,680 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'cantilever-weight'.'.'.ARG1 }
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
0.00247706 0.068554 16.6667
2.15794e-05 0.0476927 8.33333
2.37802e-05 0.0449859 4
1.70873e-05 0.0548596 2
9.83158e-06 0.0733701 1
6.86279e-06 0.0892854 0.833333
9.83158e-06 0.0771005 0.5
2.48456e-06 0.154091 0.25
EOD
$m1 << EOD
2.55481e-05 0.0482254 0.833333
9.83158e-06 0.0799727 0.5
2.48456e-06 0.159627 0.25
EOD
$m2 << EOD
0.028704 0.0235653 0.833333
0.0287041 0.0387538 0.5
0.0287042 0.0769477 0.25
EOD
$m3 << EOD
0.0725112 0.439904 16.6667
0.0385858 0.455586 8.33333
0.0195091 0.546697 4
0.0101528 0.608916 2
0.00523068 0.848232 1
0.00438576 0.921257 0.833333
0.00267231 1.34728 0.5
0.00135852 2.31591 0.25
EOD
$m4 << EOD
0.00434351 0.272707 16.6667
0.00158775 0.289258 8.33333
0.000550533 0.375537 4
0.000198268 0.439396 2
6.19618e-05 0.938153 1
4.49289e-05 0.838529 0.833333
1.84913e-05 1.23378 0.5
4.87252e-06 2.31677 0.25
EOD
$m5 << EOD
0.00434385 0.912672 16.6667
0.00158763 1.05147 8.33333
0.0005505 1.16984 4
0.000198265 1.35322 2
6.19617e-05 1.79905 1
4.4928e-05 2.08814 0.833333
EOD
$m6 << EOD
0.00434385 1.31644 16.6667
0.00158763 2.50796 8.33333
0.0005505 4.07635 4
0.000198265 7.25497 2
6.19617e-05 12.4962 1
EOD
$m7 << EOD
0.0043403 0.0350413 16.6667
0.00158729 0.0780492 8.33333
0.000550486 0.151211 4
0.000198265 0.315363 2
6.19617e-05 0.624076 1
4.4928e-05 0.695154 0.833333
1.84916e-05 1.17467 0.5
4.8726e-06 2.58266 0.25
EOD
$m8 << EOD
0.00247726 1.16893 16.6667
0.000903794 1.28556 8.33333
0.000313424 1.47446 4
0.000107311 1.82625 2
3.26495e-05 2.96429 1
EOD
$m9 << EOD
0.00247706 0.0685362 16.6667
0.000903788 0.174158 8.33333
0.000313425 0.291561 4
0.000107311 0.570693 2
3.26495e-05 1.14914 1
2.39129e-05 1.4203 0.833333
9.25636e-06 2.46544 0.5
EOD
$m10 << EOD
0.072628 0.015814 16.6667
0.0386212 0.0316344 8.33333
0.0195259 0.0661464 4
0.0101622 0.132544 2
0.00523462 0.263967 1
0.00438991 0.318893 0.833333
0.0026741 0.534714 0.5
0.0013581 1.12576 0.25
EOD
$m11 << EOD
0.0725893 0.0535488 16.6667
0.0386302 0.106171 8.33333
0.0195315 0.207571 4
0.0101642 0.402151 2
0.00523516 0.793146 1
0.00439029 0.833876 0.833333
0.00267424 1.16884 0.5
0.00135814 2.28731 0.25
EOD
$m12 << EOD
0.0287047 0.000931345 16.6667
0.0287047 0.00174257 8.33333
0.0287047 0.00344797 4
0.0287047 0.007001 2
0.0287047 0.0140903 1
0.0287047 0.0167933 0.833333
0.0287047 0.0282279 0.5
0.0287047 0.0557267 0.25
EOD
$m13 << EOD
0.0287042 0.00491584 16.6667
0.0287042 0.00992225 8.33333
0.0287042 0.0206309 4
0.0287042 0.041101 2
0.0287042 0.081846 1
0.0287042 0.0983728 0.833333
0.0287042 0.163686 0.5
0.0287042 0.327378 0.25
EOD
$rings << EOD
9.83158e-06 0.0733701
0.00523068 0.848232
6.19618e-05 0.938153
6.19617e-05 1.79905
6.19617e-05 12.4962
6.19617e-05 0.624076
3.26495e-05 2.96429
3.26495e-05 1.14914
0.00523462 0.263967
0.00523516 0.793146
0.0287047 0.0140903
0.0287042 0.081846
EOD
set logscale xy
set format x '10^{%L}'
set format y '10^{%L}'
set mxtics 1
set mytics 1
set title 'cantilever: E 1 MPa, load -40 sin^2(2 pi t) N on the tip; marks: h in ms, ringed: 1 ms' noenhanced
set xlabel 'relative error of displacements under a weight that is there at once (the reference is off by 1.7e-11)' noenhanced
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
