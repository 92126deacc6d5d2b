# SPDX-License-Identifier: Apache-2.0
# gnuplot -c f-area-small.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11'; set output 'f-area-small.png' }
else { set terminal svg size 900,560 font 'sans,13' background 'white'; set output 'f-area-small.svg' }
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
88318.4 1.23366e-11
142825 4.60039e-12
175681 2.93265e-12
234076 1.63125e-12
349136 7.38423e-13
511556 4.1394e-13
741066 3.65179e-13
EOD
$series1 << EOD
75403.5 1.19532e-09
129311 1.19393e-09
161240 1.2082e-09
218457 1.21182e-09
331806 1.21465e-09
496565 4.67469e-10
741066 3.65179e-13
EOD
$series2 << EOD
69538.4 6.25192e-09
123215 6.33596e-09
154925 6.30092e-09
212120 5.68987e-09
325993 3.4387e-09
496246 4.88226e-10
741066 3.65179e-13
EOD
$series3 << EOD
66214.1 1.52542e-08
119660 1.52281e-08
151412 1.43419e-08
208741 1.17118e-08
325220 3.86666e-09
496156 4.91089e-10
741066 3.65179e-13
EOD
$series4 << EOD
64142.1 2.78978e-08
117595 2.58807e-08
149469 2.36153e-08
207411 1.51041e-08
324976 3.9177e-09
496139 4.91614e-10
741066 3.65179e-13
EOD
$series5 << EOD
61518.7 6.20413e-08
115330 4.86353e-08
147739 3.42102e-08
206648 1.68633e-08
324933 3.95359e-09
496128 4.92397e-10
741066 3.65179e-13
EOD
$series6 << EOD
56794.9 2.4775e-07
113389 6.92696e-08
146674 4.02795e-08
206245 1.73214e-08
324865 3.98808e-09
496133 4.92965e-10
741066 3.65179e-13
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title "p" noenhanced
set title "Error of the area of interest against rate, interaction 2, small" noenhanced
set xlabel "payload [bit/s]" noenhanced
set ylabel "MSE in the area [m^2]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "-p 0%" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "-p 2.5%" noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title "-p 5%" noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title "-p 7.5%" noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title "-p 10%" noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title "-p 15%" noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title "--haptic off" noenhanced
