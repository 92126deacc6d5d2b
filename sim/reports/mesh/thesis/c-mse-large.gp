# SPDX-License-Identifier: Apache-2.0
# gnuplot -c c-mse-large.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11'; set output 'c-mse-large.png' }
else { set terminal svg size 900,560 font 'sans,13' background 'white'; set output 'c-mse-large.svg' }
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
146288 2.5956e-07
241204 6.38466e-08
291691 3.41734e-08
365126 1.39777e-08
497859 2.78436e-09
658617 2.48128e-10
772102 1.68169e-12
EOD
$series1 << EOD
131377 2.60859e-07
223752 6.42613e-08
273416 3.45895e-08
345959 1.43077e-08
481100 2.93304e-09
652307 2.60381e-10
772102 1.68169e-12
EOD
$series2 << EOD
124379 2.62393e-07
216301 6.55351e-08
266087 3.55501e-08
340696 1.47539e-08
480579 2.94028e-09
652268 2.60557e-10
772102 1.68169e-12
EOD
$series3 << EOD
120416 2.65183e-07
212854 6.68817e-08
263949 3.6075e-08
340116 1.47795e-08
480487 2.94258e-09
652198 2.60688e-10
772102 1.68169e-12
EOD
$series4 << EOD
117963 2.68219e-07
211691 6.74018e-08
263408 3.61653e-08
339814 1.47974e-08
480397 2.943e-09
652191 2.60703e-10
772102 1.68169e-12
EOD
$series5 << EOD
115144 2.74072e-07
211004 6.75919e-08
262867 3.62061e-08
339657 1.48028e-08
480323 2.94413e-09
652192 2.60713e-10
772102 1.68169e-12
EOD
$series6 << EOD
112662 2.76764e-07
209947 6.78232e-08
262183 3.63212e-08
339272 1.48227e-08
480243 2.945e-09
652191 2.60727e-10
772102 1.68169e-12
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title "p" noenhanced
set title "Error of the whole mesh against rate, interaction 1, large" noenhanced
set xlabel "payload [bit/s]" noenhanced
set ylabel "MSE [m^2]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "-p 0%" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "-p 2.5%" noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title "-p 5%" noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title "-p 7.5%" noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title "-p 10%" noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title "-p 15%" noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title "--haptic off" noenhanced
