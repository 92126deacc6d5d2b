# SPDX-License-Identifier: Apache-2.0
# gnuplot -c b-rate-small.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11'; set output 'b-rate-small.png' }
else { set terminal svg size 900,560 font 'sans,13' background 'white'; set output 'b-rate-small.svg' }
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
0 434091
0.05 55260.8
0.125 50378.9
0.25 49772.3
0.375 50054.7
0.5 50414.9
1 51298.4
EOD
$series1 << EOD
0 434133
0.05 14390.4
0.125 6889.6
0.25 5044.53
0.375 4728.53
0.5 4611.47
1 4890.67
EOD
$series2 << EOD
0 434133
0.05 14270.7
0.125 5985.87
0.25 3706.4
0.375 3236
0.5 3126.4
1 3124
EOD
$series3 << EOD
0 434136
0.05 13726.1
0.125 5915.2
0.25 3246.67
0.375 2622.93
0.5 2499.73
1 2320.27
EOD
$series4 << EOD
0 434133
0.05 14048
0.125 5763.73
0.25 3069.6
0.375 2302.93
0.5 2080.27
1 1937.6
EOD
$series5 << EOD
0 434136
0.05 13972
0.125 5631.47
0.25 2949.33
0.375 2085.07
0.5 1738.93
1 1371.47
EOD
$series6 << EOD
0 433968
0.05 13796.8
0.125 5402.4
0.25 2644.27
0.375 1729.87
0.5 1329.87
1 741.333
EOD
set key outside right top title "p" noenhanced
set title "Rate over the visual threshold, interaction 2, small, basis of 48" noenhanced
set xlabel "v [mm]" noenhanced
set ylabel "payload [bit/s]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "-p 0%" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "-p 2.5%" noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title "-p 5%" noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title "-p 7.5%" noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title "-p 10%" noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title "-p 15%" noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title "--haptic off" noenhanced
