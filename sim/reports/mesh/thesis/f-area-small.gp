# SPDX-License-Identifier: Apache-2.0
# gnuplot -c f-area-small.gp svg | png    makes f-area-small.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11' }
else { set terminal svg size 900,560 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'f-area-small'.'.'.ARG1 }
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
88462.1 1.24054e-11
143197 4.58235e-12
176072 2.91821e-12
234548 1.63482e-12
349670 7.38442e-13
511905 4.13659e-13
740934 3.69936e-13
EOD
$series1 << EOD
75696.8 1.1975e-09
129707 1.193e-09
161679 1.20329e-09
219013 1.21365e-09
332240 1.20582e-09
496955 4.69122e-10
740934 3.69936e-13
EOD
$series2 << EOD
69870.7 6.28219e-09
123567 6.35077e-09
155326 6.29735e-09
212587 5.6861e-09
326635 3.42129e-09
496649 4.91447e-10
740934 3.69936e-13
EOD
$series3 << EOD
66513.6 1.52647e-08
119979 1.52834e-08
151920 1.43817e-08
209306 1.15837e-08
325675 3.87898e-09
496627 4.92971e-10
740934 3.69936e-13
EOD
$series4 << EOD
64439.5 2.79262e-08
117913 2.58735e-08
149897 2.35066e-08
207899 1.51411e-08
325628 3.92403e-09
496630 4.93498e-10
740934 3.69936e-13
EOD
$series5 << EOD
61744 6.20122e-08
115678 4.87326e-08
148095 3.43504e-08
207294 1.68764e-08
325448 3.95036e-09
496608 4.94498e-10
740934 3.69936e-13
EOD
$series6 << EOD
57112.5 2.47313e-07
113677 6.94585e-08
147030 4.00194e-08
206680 1.75292e-08
325422 3.98323e-09
496605 4.95065e-10
740934 3.69936e-13
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title 'p' noenhanced
set title 'Error of the area of interest against rate, interaction 2, small' noenhanced
set xrange [*:*]
set yrange [*:*]
set xlabel 'payload [bit/s]' noenhanced
set ylabel 'MSE in the area [m^2]' noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title '-p 0%' noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title '-p 2.5%' noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title '-p 5%' noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title '-p 7.5%' noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title '-p 10%' noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title '-p 15%' noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title '--haptic off' noenhanced
