# SPDX-License-Identifier: Apache-2.0
# gnuplot -c e-area-large.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11'; set output 'e-area-large.png' }
else { set terminal svg size 900,560 font 'sans,13' background 'white'; set output 'e-area-large.svg' }
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
146739 1.71711e-11
241683 5.98679e-12
292017 4.0962e-12
365503 2.67852e-12
498274 1.66595e-12
658669 1.39796e-12
772199 1.3775e-12
EOD
$series1 << EOD
131879 6.10764e-09
224185 6.18947e-09
273791 6.18428e-09
346184 6.25245e-09
481576 2.87351e-09
652375 2.39945e-10
772199 1.3775e-12
EOD
$series2 << EOD
124891 3.05589e-08
216802 2.95998e-08
266461 2.56581e-08
340977 1.45208e-08
480921 3.0404e-09
652346 2.42222e-10
772199 1.3775e-12
EOD
$series3 << EOD
121129 7.23775e-08
213282 5.53445e-08
264353 3.51691e-08
340529 1.52141e-08
480877 3.07168e-09
652327 2.42541e-10
772199 1.3775e-12
EOD
$series4 << EOD
118338 1.32982e-07
212185 6.4818e-08
263800 3.6853e-08
340250 1.54186e-08
480817 3.08822e-09
652323 2.42661e-10
772199 1.3775e-12
EOD
$series5 << EOD
115622 2.28637e-07
211449 6.80949e-08
263410 3.77096e-08
340055 1.56101e-08
480713 3.10601e-09
652320 2.42932e-10
772199 1.3775e-12
EOD
$series6 << EOD
113059 2.97242e-07
210396 7.24022e-08
262620 3.934e-08
339690 1.60373e-08
480717 3.11873e-09
652313 2.43207e-10
772199 1.3775e-12
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title "p" noenhanced
set title "Error of the area of interest against rate, interaction 1, large" noenhanced
set xlabel "payload [bit/s]" noenhanced
set ylabel "MSE in the area [m^2]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "-p 0%" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "-p 2.5%" noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title "-p 5%" noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title "-p 7.5%" noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title "-p 10%" noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title "-p 15%" noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title "--haptic off" noenhanced
