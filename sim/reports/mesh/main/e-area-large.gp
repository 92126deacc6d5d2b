# SPDX-License-Identifier: Apache-2.0
# gnuplot -c e-area-large.gp svg | png    makes e-area-large.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11' }
else { set terminal svg size 900,560 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'e-area-large'.'.'.ARG1 }
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
67094.1 1.41907e-14
67155.5 1.41907e-14
67886.4 1.41907e-14
67909.3 1.41907e-14
71788.3 1.41907e-14
84651.2 1.41907e-14
583989 1.41907e-14
EOD
$series1 << EOD
5461.33 9.50092e-09
6165.87 8.75461e-09
6952.53 8.43138e-09
8594.93 7.72369e-09
14254.9 4.57584e-09
31490.9 9.85008e-10
584026 1.41907e-14
EOD
$series2 << EOD
3659.2 2.62219e-08
4517.07 2.216e-08
5494.67 1.94774e-08
7626.13 1.31807e-08
13557.9 4.83041e-09
31007.7 1.00191e-09
584026 1.41907e-14
EOD
$series3 << EOD
2885.6 4.20283e-08
4028.53 3.24989e-08
4970.4 2.29508e-08
7191.73 1.38243e-08
13461.3 4.84182e-09
31338.9 1.00999e-09
584030 1.41907e-14
EOD
$series4 << EOD
2485.87 5.52917e-08
3780.8 3.74823e-08
4849.87 2.49465e-08
7140.27 1.37963e-08
13937.9 4.76091e-09
31271.2 1.01214e-09
584026 1.41907e-14
EOD
$series5 << EOD
2085.6 7.52891e-08
3642.93 3.52553e-08
4844.27 2.45209e-08
7074.4 1.35271e-08
13586.9 4.89863e-09
31065.6 1.01444e-09
584030 1.41907e-14
EOD
$series6 << EOD
1580.53 9.57154e-08
3279.2 3.76578e-08
4538.4 2.56455e-08
6750.4 1.39308e-08
13299.2 4.93145e-09
30875.5 1.01071e-09
583857 1.41907e-14
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title 'p' noenhanced
set title 'Error of the area of interest against rate, interaction 1, large, basis of 48' noenhanced
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
