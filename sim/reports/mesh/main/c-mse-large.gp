# SPDX-License-Identifier: Apache-2.0
# gnuplot -c c-mse-large.gp svg | png    makes c-mse-large.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11' }
else { set terminal svg size 900,560 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'c-mse-large'.'.'.ARG1 }
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
67094.1 1.75965e-08
67155.5 2.47055e-08
67886.4 1.07077e-08
67909.3 5.08436e-08
71788.3 3.75702e-09
84651.2 8.03726e-10
583989 1.40563e-14
EOD
$series1 << EOD
5461.33 4.95046e-08
6165.87 2.80273e-08
6952.53 1.99894e-08
8594.93 1.15136e-08
14254.9 3.92937e-09
31490.9 8.36864e-10
584026 1.40563e-14
EOD
$series2 << EOD
3659.2 5.11759e-08
4517.07 2.66455e-08
5494.67 1.99505e-08
7626.13 1.16894e-08
13557.9 3.8492e-09
31007.7 8.37202e-10
584026 1.40563e-14
EOD
$series3 << EOD
2885.6 5.35264e-08
4028.53 2.76749e-08
4970.4 1.92128e-08
7191.73 1.11495e-08
13461.3 3.83201e-09
31338.9 8.40213e-10
584030 1.40563e-14
EOD
$series4 << EOD
2485.87 5.60108e-08
3780.8 2.93212e-08
4849.87 1.95059e-08
7140.27 1.12607e-08
13937.9 3.94479e-09
31271.2 8.37576e-10
584026 1.40563e-14
EOD
$series5 << EOD
2085.6 5.98633e-08
3642.93 2.70258e-08
4844.27 1.94307e-08
7074.4 1.09011e-08
13586.9 3.92828e-09
31065.6 8.34946e-10
584030 1.40563e-14
EOD
$series6 << EOD
1580.53 6.35674e-08
3279.2 2.68398e-08
4538.4 1.92365e-08
6750.4 1.03915e-08
13299.2 3.89365e-09
30875.5 8.34028e-10
583857 1.40563e-14
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title 'p' noenhanced
set title 'Error of the whole mesh against rate, interaction 1, large, basis of 48' noenhanced
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
