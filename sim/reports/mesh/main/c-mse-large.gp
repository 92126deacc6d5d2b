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
67164.5 1.79504e-08
67247.5 2.40024e-08
67899.5 4.7104e-08
68227.5 1.0443e-08
71670.7 3.65794e-09
84430.9 7.7274e-10
584350 1.35565e-14
EOD
$series1 << EOD
5529.6 5.0529e-08
6171.47 2.74191e-08
6902.13 1.87629e-08
8434.13 1.02067e-08
14112.8 3.76376e-09
31096.5 8.0745e-10
584392 1.35565e-14
EOD
$series2 << EOD
3686.4 5.10065e-08
4545.07 2.58661e-08
5387.73 1.89443e-08
7448.53 1.06863e-08
14033.9 3.88134e-09
30743.5 8.01136e-10
584392 1.35565e-14
EOD
$series3 << EOD
2909.87 5.27272e-08
4012.8 2.58219e-08
4960.8 1.8224e-08
7332.27 1.07268e-08
13520.5 3.71811e-09
30657.9 7.99495e-10
584391 1.35565e-14
EOD
$series4 << EOD
2509.07 5.55142e-08
3853.33 2.87214e-08
4838.93 1.84644e-08
7116.27 1.04338e-08
13800.3 3.81331e-09
30903.5 8.01905e-10
584393 1.35565e-14
EOD
$series5 << EOD
2089.87 5.57094e-08
3631.2 2.70564e-08
4724 1.81398e-08
6994.13 1.05779e-08
13738.7 3.78314e-09
30664 7.99227e-10
584391 1.35565e-14
EOD
$series6 << EOD
1564 6.11727e-08
3263.2 2.5349e-08
4450.67 1.80325e-08
6622.4 1.02459e-08
13451.7 3.79904e-09
30369.6 7.9843e-10
584226 1.35565e-14
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title "p" noenhanced
set title "Error of the whole mesh against rate, interaction 1, large, basis of 48" noenhanced
set xlabel "payload [bit/s]" noenhanced
set ylabel "MSE [m^2]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "-p 0%" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "-p 2.5%" noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title "-p 5%" noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title "-p 7.5%" noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title "-p 10%" noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title "-p 15%" noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title "--haptic off" noenhanced
