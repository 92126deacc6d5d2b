# SPDX-License-Identifier: Apache-2.0
# gnuplot -c membrane-stiff-weight.gp svg | png    makes membrane-stiff-weight.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 1100,680 font 'sans,11' }
else { set terminal svg size 1100,680 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'membrane-stiff-weight'.'.'.ARG1 }
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
0.447043 0.0886015 16.6667
0.11924 0.168331 8.33333
0.0335011 0.271523 4
0.0110771 0.403505 2
5.00765e-05 0.410915 1
4.28414e-05 0.445325 0.5
4.28414e-05 0.472265 0.25
1.63615e-05 0.794689 0.1
EOD
$m1 << EOD
5.93144e-05 0.398581 0.1
EOD
$m2 << EOD
0.00043393 0.200843 0.1
EOD
$m3 << EOD
0.474705 1.50682 16.6667
0.459836 2.62999 8.33333
0.438765 3.73084 4
0.376846 4.61001 2
0.273521 6.35047 1
EOD
$m4 << EOD
0.954402 1.22281 16.6667
0.229382 2.09292 8.33333
0.0634862 2.59576 4
0.0183885 2.81338 2
0.00620747 3.9119 1
EOD
$m5 << EOD
0.954406 3.63295 16.6667
0.229384 5.27921 8.33333
0.0634869 5.85931 4
0.0183887 6.52686 2
0.00620751 6.24166 1
EOD
$m6 << EOD
0.954406 0.886571 16.6667
0.229384 1.74434 8.33333
0.0634869 3.36246 4
0.0183887 5.84281 2
0.00620751 10.7278 1
EOD
$m7 << EOD
0.954321 0.0460511 16.6667
0.229371 0.0953288 8.33333
0.0634848 0.196448 4
0.0183886 0.341313 2
0.00620751 0.684314 1
0.00181904 1.36444 0.5
0.000487437 2.72531 0.25
EOD
$m8 << EOD
0.447055 5.52451 16.6667
0.119242 6.70847 8.33333
0.0335012 8.37895 4
0.0110771 10.9004 2
0.00352615 10.7058 1
EOD
$m9 << EOD
0.447043 0.0813161 16.6667
0.11924 0.162924 8.33333
0.0335011 0.340975 4
0.0110771 0.690932 2
0.00352615 1.37298 1
0.000833566 2.83883 0.5
EOD
$m10 << EOD
0.474709 0.019207 16.6667
0.459836 0.0380155 8.33333
0.438765 0.079124 4
0.376847 0.158859 2
0.273522 0.316688 1
0.171098 0.642698 0.5
0.0970303 1.28591 0.25
0.0423439 3.24233 0.1
EOD
$m11 << EOD
0.474705 0.0594465 16.6667
0.459836 0.116656 8.33333
0.438765 0.230949 4
0.376847 0.438796 2
0.273522 0.745146 1
0.171098 1.37189 0.5
0.0970303 2.89232 0.25
EOD
$m12 << EOD
0.000819762 0.00116607 16.6667
0.000819762 0.00240343 8.33333
0.000819762 0.00553162 4
0.000819762 0.00975164 2
0.000819762 0.019602 1
0.000819762 0.0384463 0.5
0.000819762 0.0782485 0.25
0.000819762 0.20824 0.1
EOD
$m13 << EOD
0.000436321 0.00705738 16.6667
0.000436321 0.0141398 8.33333
0.000436321 0.0292829 4
0.000436321 0.0591192 2
0.000436321 0.117768 1
0.000436321 0.233851 0.5
0.000436321 0.494373 0.25
0.000436321 1.18102 0.1
EOD
$rings << EOD
5.00765e-05 0.410915
0.273521 6.35047
0.00620747 3.9119
0.00620751 6.24166
0.00620751 10.7278
0.00620751 0.684314
0.00352615 10.7058
0.00352615 1.37298
0.273522 0.316688
0.273522 0.745146
0.000819762 0.019602
0.000436321 0.117768
EOD
set logscale xy
set format x '10^{%L}'
set format y '10^{%L}'
set mxtics 1
set mytics 1
set title 'stiff membrane: E 10 MPa, load -sin^2(2 pi t) N at the centre; marks: h in ms, ringed: 1 ms' noenhanced
set xlabel 'relative error of displacements under a weight that is there at once (the reference is off by 6.8e-10)' noenhanced
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
