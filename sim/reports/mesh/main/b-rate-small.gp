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
0 433981
0.05 55394.7
0.125 50574.7
0.25 49678.7
0.375 49860
0.5 50543.7
1 51373.9
EOD
$series1 << EOD
0 434022
0.05 14475.7
0.125 6984.8
0.25 5068
0.375 4688.27
0.5 4681.33
1 4887.47
EOD
$series2 << EOD
0 434021
0.05 13870.7
0.125 6049.33
0.25 3778.4
0.375 3283.2
0.5 3127.73
1 3140
EOD
$series3 << EOD
0 434019
0.05 13968.3
0.125 5846.67
0.25 3248.53
0.375 2623.2
0.5 2522.67
1 2382.13
EOD
$series4 << EOD
0 434021
0.05 13680
0.125 5757.6
0.25 3016.8
0.375 2405.07
0.5 2091.2
1 1904.53
EOD
$series5 << EOD
0 434019
0.05 13789.3
0.125 5662.93
0.25 2864.27
0.375 2090.67
0.5 1690.4
1 1358.4
EOD
$series6 << EOD
0 433859
0.05 13446.1
0.125 5364
0.25 2672.27
0.375 1736.53
0.5 1353.07
1 733.867
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
