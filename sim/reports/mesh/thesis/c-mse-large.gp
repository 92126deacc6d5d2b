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
146739 2.59421e-07
241683 6.3881e-08
292017 3.41701e-08
365503 1.39794e-08
498274 2.78001e-09
658669 2.48094e-10
772199 1.69055e-12
EOD
$series1 << EOD
131879 2.60297e-07
224185 6.43444e-08
273791 3.45253e-08
346184 1.43033e-08
481576 2.92961e-09
652375 2.60314e-10
772199 1.69055e-12
EOD
$series2 << EOD
124891 2.62301e-07
216802 6.55419e-08
266461 3.5513e-08
340977 1.47296e-08
480921 2.93974e-09
652346 2.60436e-10
772199 1.69055e-12
EOD
$series3 << EOD
121129 2.64821e-07
213282 6.68801e-08
264353 3.60592e-08
340529 1.47774e-08
480877 2.93936e-09
652327 2.60451e-10
772199 1.69055e-12
EOD
$series4 << EOD
118338 2.68203e-07
212185 6.73546e-08
263800 3.61349e-08
340250 1.47704e-08
480817 2.94006e-09
652323 2.60457e-10
772199 1.69055e-12
EOD
$series5 << EOD
115622 2.73588e-07
211449 6.76108e-08
263410 3.62228e-08
340055 1.47835e-08
480713 2.94097e-09
652320 2.6047e-10
772199 1.69055e-12
EOD
$series6 << EOD
113059 2.76885e-07
210396 6.78435e-08
262620 3.62651e-08
339690 1.48016e-08
480717 2.94258e-09
652313 2.60484e-10
772199 1.69055e-12
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
