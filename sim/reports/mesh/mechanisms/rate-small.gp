# SPDX-License-Identifier: Apache-2.0
# gnuplot -c rate-small.gp svg | png    makes rate-small.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11' }
else { set terminal svg size 900,560 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'rate-small'.'.'.ARG1 }
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
4 301927
6 506565
7 622276
8 740934
9 858793
10 972578
12 1.19283e+06
EOD
$series1 << EOD
4 111340
6 162417
7 190554
8 219013
9 247566
10 276179
12 333560
EOD
set logscale y
set format y '10^{%L}'
set key outside right top title 'thresholds' noenhanced
set title 'Rate over the bits of the quantiser, interaction 2' noenhanced
set xrange [*:*]
set yrange [*:*]
set xlabel 'q [bit]' noenhanced
set ylabel 'payload [bit/s]' noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title '--mesh-visual 0 -p 0%' noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title '--mesh-visual 0.25mm -p 2.5%' noenhanced
