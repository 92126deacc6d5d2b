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
0 741066
0.05 511556
0.125 349136
0.25 234076
0.375 175681
0.5 142825
1 88318.4
EOD
$series1 << EOD
0 741066
0.05 496565
0.125 331806
0.25 218457
0.375 161240
0.5 129311
1 75403.5
EOD
$series2 << EOD
0 741066
0.05 496246
0.125 325993
0.25 212120
0.375 154925
0.5 123215
1 69538.4
EOD
$series3 << EOD
0 741066
0.05 496156
0.125 325220
0.25 208741
0.375 151412
0.5 119660
1 66214.1
EOD
$series4 << EOD
0 741066
0.05 496139
0.125 324976
0.25 207411
0.375 149469
0.5 117595
1 64142.1
EOD
$series5 << EOD
0 741066
0.05 496128
0.125 324933
0.25 206648
0.375 147739
0.5 115330
1 61518.7
EOD
$series6 << EOD
0 741066
0.05 496133
0.125 324865
0.25 206245
0.375 146674
0.5 113389
1 56794.9
EOD
set key outside right top title "p" noenhanced
set title "Rate over the visual threshold, interaction 2, small" noenhanced
set xlabel "v [mm]" noenhanced
set ylabel "payload [bit/s]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "-p 0%" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "-p 2.5%" noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title "-p 5%" noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title "-p 7.5%" noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title "-p 10%" noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title "-p 15%" noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title "--haptic off" noenhanced
