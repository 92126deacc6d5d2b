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
67164.5 1.42303e-14
67247.5 1.42303e-14
67899.5 1.42303e-14
68227.5 1.42303e-14
71670.7 1.42303e-14
84430.9 1.42303e-14
584350 1.42303e-14
EOD
$series1 << EOD
5529.6 9.39223e-09
6171.47 8.55865e-09
6902.13 8.5944e-09
8434.13 7.73182e-09
14112.8 4.47953e-09
31096.5 9.87454e-10
584392 1.42303e-14
EOD
$series2 << EOD
3686.4 2.64229e-08
4545.07 2.25741e-08
5387.73 1.96464e-08
7448.53 1.2809e-08
14033.9 4.78014e-09
30743.5 1.00056e-09
584392 1.42303e-14
EOD
$series3 << EOD
2909.87 4.16272e-08
4012.8 3.19167e-08
4960.8 2.36288e-08
7332.27 1.37517e-08
13520.5 4.7411e-09
30657.9 1.00357e-09
584391 1.42303e-14
EOD
$series4 << EOD
2509.07 5.68851e-08
3853.33 3.70658e-08
4838.93 2.36394e-08
7116.27 1.37044e-08
13800.3 4.88092e-09
30903.5 1.0081e-09
584393 1.42303e-14
EOD
$series5 << EOD
2089.87 7.72451e-08
3631.2 3.84837e-08
4724 2.37788e-08
6994.13 1.39035e-08
13738.7 4.89493e-09
30664 1.00827e-09
584391 1.42303e-14
EOD
$series6 << EOD
1564 9.54035e-08
3263.2 3.77596e-08
4450.67 2.51912e-08
6622.4 1.39265e-08
13451.7 4.94426e-09
30369.6 1.00869e-09
584226 1.42303e-14
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title "p" noenhanced
set title "Error of the area of interest against rate, interaction 1, large, basis of 48" noenhanced
set xlabel "payload [bit/s]" noenhanced
set ylabel "MSE in the area [m^2]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "-p 0%" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "-p 2.5%" noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title "-p 5%" noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title "-p 7.5%" noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title "-p 10%" noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title "-p 15%" noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title "--haptic off" noenhanced
