# SPDX-License-Identifier: Apache-2.0
# gnuplot -c d-mse-small.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11'; set output 'd-mse-small.png' }
else { set terminal svg size 900,560 font 'sans,13' background 'white'; set output 'd-mse-small.svg' }
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
$series0 << EOD
88318.4 2.33245e-07
142825 6.2942e-08
175681 3.58201e-08
234076 1.53306e-08
349136 3.37046e-09
511556 3.98651e-10
741066 5.5791e-13
EOD
$series1 << EOD
75403.5 2.33371e-07
129311 6.30671e-08
161240 3.58708e-08
218457 1.54167e-08
331806 3.43615e-09
496565 4.2175e-10
741066 5.5791e-13
EOD
$series2 << EOD
69538.4 2.33917e-07
123215 6.33963e-08
154925 3.62209e-08
212120 1.56614e-08
325993 3.55285e-09
496246 4.2286e-10
741066 5.5791e-13
EOD
$series3 << EOD
66214.1 2.3475e-07
119660 6.39524e-08
151412 3.66304e-08
208741 1.59783e-08
325220 3.56988e-09
496156 4.23233e-10
741066 5.5791e-13
EOD
$series4 << EOD
64142.1 2.35707e-07
117595 6.44586e-08
149469 3.70504e-08
207411 1.61577e-08
324976 3.5697e-09
496139 4.23265e-10
741066 5.5791e-13
EOD
$series5 << EOD
61518.7 2.37445e-07
115330 6.55419e-08
147739 3.76301e-08
206648 1.62278e-08
324933 3.57315e-09
496128 4.23312e-10
741066 5.5791e-13
EOD
$series6 << EOD
56794.9 2.47001e-07
113389 6.67219e-08
146674 3.79497e-08
206245 1.62424e-08
324865 3.57493e-09
496133 4.233e-10
741066 5.5791e-13
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title "p" noenhanced
set title "Error of the whole mesh against rate, interaction 2, small" noenhanced
set xlabel "payload [bit/s]" noenhanced
set ylabel "MSE [m^2]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "-p 0%" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "-p 2.5%" noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title "-p 5%" noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title "-p 7.5%" noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title "-p 10%" noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title "-p 15%" noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title "--haptic off" noenhanced
