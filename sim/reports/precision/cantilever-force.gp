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
3.55074e-06 0.0724745 0.833333
1.28158e-06 0.120072 0.5
3.20408e-07 0.240064 0.25
EOD
$m1 << EOD
0.000671778 0.0313771 0.833333
0.000669864 0.0521742 0.5
0.000669059 0.104904 0.25
EOD
$m2 << EOD
0.10046 0.333158 16.6667
0.0529768 0.377795 8.33333
0.0262771 0.434211 4
0.0133836 0.525173 2
0.00676567 0.751154 1
0.00564942 0.844671 0.833333
0.00340392 1.25123 0.5
0.00170663 2.28101 0.25
EOD
$m3 << EOD
0.000920914 0.213821 16.6667
0.00022879 0.238038 8.33333
4.83454e-05 0.293445 4
1.17733e-05 0.413408 2
2.96047e-06 0.682424 1
2.06857e-06 0.790499 0.833333
7.70426e-07 1.22877 0.5
1.9828e-07 2.34484 0.25
EOD
$m4 << EOD
0.000921037 0.677816 16.6667
0.000228813 0.754302 8.33333
4.83534e-05 0.806979 4
1.17784e-05 0.984478 2
2.9628e-06 1.44322 1
2.07013e-06 1.6545 0.833333
7.70354e-07 2.36686 0.5
EOD
$m5 << EOD
0.000921037 1.07155 16.6667
0.000228813 2.02596 8.33333
4.83534e-05 3.58112 4
1.17784e-05 6.17626 2
2.96281e-06 11.0785 1
EOD
$m6 << EOD
0.000920295 0.0251195 16.6667
0.000228772 0.0497264 8.33333
4.83517e-05 0.102449 4
1.17785e-05 0.205855 2
2.97294e-06 0.405515 1
2.08199e-06 0.485583 0.833333
7.73225e-07 0.486952 0.5
1.98533e-07 0.842831 0.25
EOD
$m7 << EOD
0.00108036 0.853824 16.6667
0.000252711 0.922274 8.33333
5.32858e-05 1.0758 4
1.26785e-05 1.5288 2
3.11267e-06 2.42252 1
EOD
$m8 << EOD
0.00108048 0.0486596 16.6667
0.000252718 0.0964029 8.33333
5.32863e-05 0.200658 4
1.26753e-05 0.399588 2
3.11539e-06 0.594662 1
2.16075e-06 0.533593 0.833333
7.79493e-07 0.825467 0.5
1.94473e-07 1.58485 0.25
EOD
$m9 << EOD
0.100674 0.0108198 16.6667
0.053021 0.0215387 8.33333
0.0262869 0.0450101 4
0.0133882 0.0901003 2
0.00676837 0.180026 1
0.00565176 0.215271 0.833333
0.00340557 0.360737 0.5
0.0017086 0.72009 0.25
EOD
$m10 << EOD
0.100496 0.0346951 16.6667
0.052998 0.0681906 8.33333
0.0262885 0.136362 4
0.0133897 0.22642 2
0.0067689 0.409086 1
0.00565215 0.490896 0.833333
0.00340573 0.792213 0.5
0.00170864 0.848507 0.25
EOD
$m11 << EOD
0.000837349 0.00115864 16.6667
0.00101727 0.00230883 8.33333
0.00118521 0.00481253 4
0.00122484 0.00960242 2
0.00123476 0.0189781 1
0.00123577 0.0227022 0.833333
0.00123724 0.0377938 0.5
0.00123785 0.0760574 0.25
EOD
$m12 << EOD
0.00102414 0.00503228 16.6667
0.000674237 0.0100663 8.33333
0.000793937 0.0208292 4
0.000826691 0.0415544 2
0.000834951 0.0836883 1
0.000835789 0.100647 0.833333
0.000837004 0.166327 0.5
0.000837515 0.33352 0.25
EOD
$rings << EOD
0.00676567 0.751154
2.96047e-06 0.682424
2.9628e-06 1.44322
2.96281e-06 11.0785
2.97294e-06 0.405515
3.11267e-06 2.42252
3.11539e-06 0.594662
0.00676837 0.180026
0.0067689 0.409086
0.00123476 0.0189781
0.000834951 0.0836883
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
