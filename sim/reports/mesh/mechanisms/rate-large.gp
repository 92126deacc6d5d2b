# SPDX-License-Identifier: Apache-2.0
# gnuplot -c rate-large.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11'; set output 'rate-large.png' }
else { set terminal svg size 900,560 font 'sans,13' background 'white'; set output 'rate-large.svg' }
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
4 315169
6 532666
7 651317
8 772102
9 893428
10 1.01414e+06
12 1.25129e+06
EOD
$series1 << EOD
4 171732
6 255731
7 300591
8 345959
9 391395
10 436834
12 528006
EOD
set logscale y
set format y '10^{%L}'
set key outside right top title "thresholds" noenhanced
set title "Rate over the bits of the quantiser, interaction 1" noenhanced
set xlabel "q [bit]" noenhanced
set ylabel "payload [bit/s]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "--mesh-visual 0 -p 0%" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "--mesh-visual 0.25mm -p 2.5%" noenhanced
