# SPDX-License-Identifier: Apache-2.0
# gnuplot -c a-rate-large.gp svg | png    makes a-rate-large.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11' }
else { set terminal svg size 900,560 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'a-rate-large'.'.'.ARG1 }
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
0 583989
0.05 84651.2
0.125 71788.3
0.25 67886.4
0.375 67094.1
0.5 67155.5
1 67909.3
EOD
$series1 << EOD
0 584026
0.05 31490.9
0.125 14254.9
0.25 8594.93
0.375 6952.53
0.5 6165.87
1 5461.33
EOD
$series2 << EOD
0 584026
0.05 31007.7
0.125 13557.9
0.25 7626.13
0.375 5494.67
0.5 4517.07
1 3659.2
EOD
$series3 << EOD
0 584030
0.05 31338.9
0.125 13461.3
0.25 7191.73
0.375 4970.4
0.5 4028.53
1 2885.6
EOD
$series4 << EOD
0 584026
0.05 31271.2
0.125 13937.9
0.25 7140.27
0.375 4849.87
0.5 3780.8
1 2485.87
EOD
$series5 << EOD
0 584030
0.05 31065.6
0.125 13586.9
0.25 7074.4
0.375 4844.27
0.5 3642.93
1 2085.6
EOD
$series6 << EOD
0 583857
0.05 30875.5
0.125 13299.2
0.25 6750.4
0.375 4538.4
0.5 3279.2
1 1580.53
EOD
set key outside right top title 'p' noenhanced
set title 'Rate over the visual threshold, interaction 1, large, basis of 48' noenhanced
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
