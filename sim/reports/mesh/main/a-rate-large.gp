# SPDX-License-Identifier: Apache-2.0
# gnuplot -c a-rate-large.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11'; set output 'a-rate-large.png' }
else { set terminal svg size 900,560 font 'sans,13' background 'white'; set output 'a-rate-large.svg' }
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
0 584350
0.05 84430.9
0.125 71670.7
0.25 68227.5
0.375 67164.5
0.5 67247.5
1 67899.5
EOD
$series1 << EOD
0 584392
0.05 31096.5
0.125 14112.8
0.25 8434.13
0.375 6902.13
0.5 6171.47
1 5529.6
EOD
$series2 << EOD
0 584392
0.05 30743.5
0.125 14033.9
0.25 7448.53
0.375 5387.73
0.5 4545.07
1 3686.4
EOD
$series3 << EOD
0 584391
0.05 30657.9
0.125 13520.5
0.25 7332.27
0.375 4960.8
0.5 4012.8
1 2909.87
EOD
$series4 << EOD
0 584393
0.05 30903.5
0.125 13800.3
0.25 7116.27
0.375 4838.93
0.5 3853.33
1 2509.07
EOD
$series5 << EOD
0 584391
0.05 30664
0.125 13738.7
0.25 6994.13
0.375 4724
0.5 3631.2
1 2089.87
EOD
$series6 << EOD
0 584226
0.05 30369.6
0.125 13451.7
0.25 6622.4
0.375 4450.67
0.5 3263.2
1 1564
EOD
set key outside right top title "p" noenhanced
set title "Rate over the visual threshold, interaction 1, large, basis of 48" noenhanced
set xlabel "v [mm]" noenhanced
set ylabel "payload [bit/s]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "-p 0%" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "-p 2.5%" noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title "-p 5%" noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title "-p 7.5%" noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title "-p 10%" noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title "-p 15%" noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title "--haptic off" noenhanced
