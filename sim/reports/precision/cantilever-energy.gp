# SPDX-License-Identifier: Apache-2.0
# gnuplot -c cantilever-energy.gp svg | png    makes cantilever-energy.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 1100,680 font 'sans,11' }
else { set terminal svg size 1100,680 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'cantilever-energy'.'.'.ARG1 }
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
0.00150508 0.068554 16.6667
0.000190356 0.0476927 8.33333
4.9352e-05 0.0449859 4
1.23353e-05 0.0548596 2
3.04156e-06 0.0733701 1
2.11206e-06 0.0892854 0.833333
8.22884e-07 0.0771005 0.5
2.05775e-07 0.154091 0.25
EOD
$m1 << EOD
2.29133e-06 0.0482254 0.833333
8.22884e-07 0.0799727 0.5
2.05775e-07 0.159627 0.25
EOD
$m2 << EOD
0.00300921 0.0235653 0.833333
0.00301038 0.0387538 0.5
0.00301087 0.0769477 0.25
EOD
$m3 << EOD
0.146444 0.439904 16.6667
0.0753643 0.455586 8.33333
0.0366577 0.546697 4
0.0184355 0.608916 2
0.00924405 0.848232 1
0.00770653 0.921257 0.833333
0.00462801 1.34728 0.5
0.00231804 2.31591 0.25
EOD
$m4 << EOD
0.00224057 0.272707 16.6667
0.000551137 0.289258 8.33333
0.000128045 0.375537 4
3.20115e-05 0.439396 2
8.00589e-06 0.938153 1
5.55933e-06 0.838529 0.833333
2.00769e-06 1.23378 0.5
5.03074e-07 2.31677 0.25
EOD
$m5 << EOD
0.00225344 0.912672 16.6667
0.000553918 1.05147 8.33333
0.00012865 1.16984 4
3.21643e-05 1.35322 2
8.04408e-06 1.79905 1
5.58525e-06 2.08814 0.833333
EOD
$m6 << EOD
0.00225344 1.31644 16.6667
0.000553918 2.50796 8.33333
0.00012865 4.07635 4
3.21643e-05 7.25497 2
8.04408e-06 12.4962 1
EOD
$m7 << EOD
0.0021987 0.0350413 16.6667
0.000550433 0.0780492 8.33333
0.000128503 0.151211 4
3.21534e-05 0.315363 2
8.04312e-06 0.624076 1
5.5848e-06 0.695154 0.833333
2.01586e-06 1.17467 0.5
5.0528e-07 2.58266 0.25
EOD
$m8 << EOD
0.00150761 1.16893 16.6667
0.000375769 1.28556 8.33333
8.65832e-05 1.47446 4
2.1624e-05 1.82625 2
5.40922e-06 2.96429 1
EOD
$m9 << EOD
0.00150507 0.0685362 16.6667
0.000375616 0.174158 8.33333
8.65749e-05 0.291561 4
2.16229e-05 0.570693 2
5.40922e-06 1.14914 1
3.75916e-06 1.4203 0.833333
1.3551e-06 2.46544 0.5
EOD
$m10 << EOD
0.146263 0.015814 16.6667
0.0752938 0.0316344 8.33333
0.0367135 0.0661464 4
0.0184998 0.132544 2
0.00928798 0.263967 1
0.00774544 0.318893 0.833333
0.00465394 0.534714 0.5
0.00232955 1.12576 0.25
EOD
$m11 << EOD
0.147124 0.0535488 16.6667
0.0757611 0.106171 8.33333
0.0368641 0.207571 4
0.0185428 0.402151 2
0.00929939 0.793146 1
0.00775344 0.833876 0.833333
0.00465688 1.16884 0.5
0.0023303 2.28731 0.25
EOD
$m12 << EOD
0.00215391 0.000931345 16.6667
0.00274237 0.00174257 8.33333
0.00289771 0.00344797 4
0.00293276 0.007001 2
0.00294154 0.0140903 1
0.00294243 0.0167933 0.833333
0.00294373 0.0282279 0.5
0.00294428 0.0557267 0.25
EOD
$m13 << EOD
0.00220803 0.00491584 16.6667
0.00277109 0.00992225 8.33333
0.0029289 0.0206309 4
0.00296449 0.041101 2
0.0029734 0.081846 1
0.0029743 0.0983728 0.833333
0.00297562 0.163686 0.5
0.00297618 0.327378 0.25
EOD
$rings << EOD
3.04156e-06 0.0733701
0.00924405 0.848232
8.00589e-06 0.938153
8.04408e-06 1.79905
8.04408e-06 12.4962
8.04312e-06 0.624076
5.40922e-06 2.96429
5.40922e-06 1.14914
0.00928798 0.263967
0.00929939 0.793146
0.00294154 0.0140903
0.0029734 0.081846
EOD
set logscale xy
set format x '10^{%L}'
set format y '10^{%L}'
set mxtics 1
set mytics 1
set title 'cantilever: E 1 MPa, load -40 sin^2(2 pi t) N on the tip; marks: h in ms, ringed: 1 ms' noenhanced
set xlabel 'relative error of energy (the reference is off by 1.8e-14)' noenhanced
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
