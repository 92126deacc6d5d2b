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
4.94382e-06 0.0724745 0.833333
1.78078e-06 0.120072 0.5
4.45196e-07 0.240064 0.25
EOD
$m1 << EOD
0.00301543 0.0313771 0.833333
0.00301261 0.0521742 0.5
0.00301142 0.104904 0.25
EOD
$m2 << EOD
0.146444 0.333158 16.6667
0.0753643 0.377795 8.33333
0.0366577 0.434211 4
0.0184355 0.525173 2
0.00924405 0.751154 1
0.00770653 0.844671 0.833333
0.00462801 1.25123 0.5
0.00231804 2.28101 0.25
EOD
$m3 << EOD
0.00224057 0.213821 16.6667
0.000551137 0.238038 8.33333
0.000128046 0.293445 4
3.20117e-05 0.413408 2
8.00603e-06 0.682424 1
5.55947e-06 0.790499 0.833333
2.00784e-06 1.22877 0.5
5.03217e-07 2.34484 0.25
EOD
$m4 << EOD
0.00225344 0.677816 16.6667
0.000553919 0.754302 8.33333
0.000128664 0.806979 4
3.21658e-05 0.984478 2
8.04327e-06 1.44322 1
5.58501e-06 1.6545 0.833333
2.01478e-06 2.36686 0.5
EOD
$m5 << EOD
0.00225344 1.07155 16.6667
0.000553919 2.02596 8.33333
0.000128664 3.58112 4
3.21658e-05 6.17626 2
8.04328e-06 11.0785 1
EOD
$m6 << EOD
0.00225101 0.0251195 16.6667
0.00055322 0.0497264 8.33333
0.000128651 0.102449 4
3.2166e-05 0.205855 2
8.04362e-06 0.405515 1
5.59462e-06 0.485583 0.833333
2.09692e-06 0.486952 0.5
5.18405e-07 0.842831 0.25
EOD
$m7 << EOD
0.00150761 0.853824 16.6667
0.000375787 0.922274 8.33333
8.65861e-05 1.0758 4
2.16229e-05 1.5288 2
5.40721e-06 2.42252 1
EOD
$m8 << EOD
0.00150504 0.0486596 16.6667
0.000375883 0.0964029 8.33333
8.66025e-05 0.200658 4
2.16234e-05 0.399588 2
5.47127e-06 0.594662 1
3.80588e-06 0.533593 0.833333
1.36673e-06 0.825467 0.5
3.41165e-07 1.58485 0.25
EOD
$m9 << EOD
0.151356 0.0108198 16.6667
0.0763394 0.0215387 8.33333
0.0368645 0.0450101 4
0.0185207 0.0901003 2
0.00929069 0.180026 1
0.00774701 0.215271 0.833333
0.00465428 0.360737 0.5
0.00232959 0.72009 0.25
EOD
$m10 << EOD
0.147122 0.0346951 16.6667
0.075761 0.0681906 8.33333
0.0368641 0.136362 4
0.0185428 0.22642 2
0.00929939 0.409086 1
0.00775345 0.490896 0.833333
0.00465689 0.792213 0.5
0.00233032 0.848507 0.25
EOD
$m11 << EOD
0.00215391 0.00115864 16.6667
0.00274237 0.00230883 8.33333
0.00289771 0.00481253 4
0.00293276 0.00960242 2
0.00294154 0.0189781 1
0.00294243 0.0227022 0.833333
0.00294373 0.0377938 0.5
0.00294428 0.0760574 0.25
EOD
$m12 << EOD
0.00220803 0.00503228 16.6667
0.00277109 0.0100663 8.33333
0.0029289 0.0208292 4
0.00296449 0.0415544 2
0.0029734 0.0836883 1
0.0029743 0.100647 0.833333
0.00297562 0.166327 0.5
0.00297618 0.33352 0.25
EOD
$rings << EOD
0.00924405 0.751154
8.00603e-06 0.682424
8.04327e-06 1.44322
8.04328e-06 11.0785
8.04362e-06 0.405515
5.40721e-06 2.42252
5.47127e-06 0.594662
0.00929069 0.180026
0.00929939 0.409086
0.00294154 0.0189781
0.0029734 0.0836883
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
