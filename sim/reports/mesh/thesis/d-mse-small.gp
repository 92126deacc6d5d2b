# SPDX-License-Identifier: Apache-2.0
# gnuplot -c d-mse-small.gp svg | png    makes d-mse-small.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11' }
else { set terminal svg size 900,560 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'd-mse-small'.'.'.ARG1 }
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
88462.1 2.42093e-07
143197 6.55009e-08
176072 3.72036e-08
234548 1.59473e-08
349670 3.49986e-09
511905 4.13572e-10
740934 5.86381e-13
EOD
$series1 << EOD
75696.8 2.4232e-07
129707 6.55704e-08
161679 3.73037e-08
219013 1.60256e-08
332240 3.57374e-09
496955 4.37701e-10
740934 5.86381e-13
EOD
$series2 << EOD
69870.7 2.43036e-07
123567 6.59915e-08
155326 3.76285e-08
212587 1.62892e-08
326635 3.68663e-09
496649 4.38692e-10
740934 5.86381e-13
EOD
$series3 << EOD
66513.6 2.43443e-07
119979 6.64189e-08
151920 3.80462e-08
209306 1.66072e-08
325675 3.70988e-09
496627 4.38764e-10
740934 5.86381e-13
EOD
$series4 << EOD
64439.5 2.44729e-07
117913 6.7078e-08
149897 3.85234e-08
207899 1.67832e-08
325628 3.71296e-09
496630 4.38791e-10
740934 5.86381e-13
EOD
$series5 << EOD
61744 2.46496e-07
115678 6.82246e-08
148095 3.9143e-08
207294 1.6863e-08
325448 3.71484e-09
496608 4.38843e-10
740934 5.86381e-13
EOD
$series6 << EOD
57112.5 2.56569e-07
113677 6.93535e-08
147030 3.94736e-08
206680 1.69119e-08
325422 3.71577e-09
496605 4.38869e-10
740934 5.86381e-13
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title 'p' noenhanced
set title 'Error of the whole mesh against rate, interaction 2, small' noenhanced
set xrange [*:*]
set yrange [*:*]
set xlabel 'payload [bit/s]' noenhanced
set ylabel 'MSE [m^2]' noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title '-p 0%' noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title '-p 2.5%' noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title '-p 5%' noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title '-p 7.5%' noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title '-p 10%' noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title '-p 15%' noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title '--haptic off' noenhanced
