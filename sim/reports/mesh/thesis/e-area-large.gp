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
146288 1.71507e-11
241204 5.98371e-12
291691 4.0908e-12
365126 2.67171e-12
497859 1.65857e-12
658617 1.3872e-12
772102 1.372e-12
EOD
$series1 << EOD
131377 6.13233e-09
223752 6.16994e-09
273416 6.20935e-09
345959 6.23562e-09
481100 2.87804e-09
652307 2.3833e-10
772102 1.372e-12
EOD
$series2 << EOD
124379 3.04508e-08
216301 2.95668e-08
266087 2.56887e-08
340696 1.46028e-08
480579 3.04006e-09
652268 2.40281e-10
772102 1.372e-12
EOD
$series3 << EOD
120416 7.27034e-08
212854 5.54425e-08
263949 3.52113e-08
340116 1.52665e-08
480487 3.07614e-09
652198 2.41412e-10
772102 1.372e-12
EOD
$series4 << EOD
117963 1.33292e-07
211691 6.44084e-08
263408 3.69596e-08
339814 1.54671e-08
480397 3.09009e-09
652191 2.41691e-10
772102 1.372e-12
EOD
$series5 << EOD
115144 2.30467e-07
211004 6.77086e-08
262867 3.77433e-08
339657 1.56839e-08
480323 3.11074e-09
652192 2.41851e-10
772102 1.372e-12
EOD
$series6 << EOD
112662 2.95589e-07
209947 7.20525e-08
262183 3.93755e-08
339272 1.61143e-08
480243 3.12275e-09
652191 2.42129e-10
772102 1.372e-12
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
