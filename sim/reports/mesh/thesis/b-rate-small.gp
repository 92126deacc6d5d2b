# SPDX-License-Identifier: Apache-2.0
# gnuplot -c b-rate-small.gp svg | png    makes b-rate-small.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11' }
else { set terminal svg size 900,560 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'b-rate-small'.'.'.ARG1 }
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
0 740934
0.05 511905
0.125 349670
0.25 234548
0.375 176072
0.5 143197
1 88462.1
EOD
$series1 << EOD
0 740934
0.05 496955
0.125 332240
0.25 219013
0.375 161679
0.5 129707
1 75696.8
EOD
$series2 << EOD
0 740934
0.05 496649
0.125 326635
0.25 212587
0.375 155326
0.5 123567
1 69870.7
EOD
$series3 << EOD
0 740934
0.05 496627
0.125 325675
0.25 209306
0.375 151920
0.5 119979
1 66513.6
EOD
$series4 << EOD
0 740934
0.05 496630
0.125 325628
0.25 207899
0.375 149897
0.5 117913
1 64439.5
EOD
$series5 << EOD
0 740934
0.05 496608
0.125 325448
0.25 207294
0.375 148095
0.5 115678
1 61744
EOD
$series6 << EOD
0 740934
0.05 496605
0.125 325422
0.25 206680
0.375 147030
0.5 113677
1 57112.5
EOD
set key outside right top title 'p' noenhanced
set title 'Rate over the visual threshold, interaction 2, small' noenhanced
set xrange [*:*]
set yrange [*:*]
set xlabel 'v [mm]' noenhanced
set ylabel 'payload [bit/s]' noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title '-p 0%' noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title '-p 2.5%' noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title '-p 5%' noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title '-p 7.5%' noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title '-p 10%' noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title '-p 15%' noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title '--haptic off' noenhanced
