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
49840.3 4.91076e-09
50116.5 7.20384e-09
50233.3 2.15078e-09
50445.6 9.94684e-09
51292.5 2.56015e-08
55511.2 6.05116e-10
434380 1.40428e-14
EOD
$series1 << EOD
4670.4 1.00915e-08
4682.67 7.18228e-09
4870.93 2.60483e-08
5061.33 4.86421e-09
7026.67 2.43131e-09
14510.4 6.37983e-10
434422 1.40428e-14
EOD
$series2 << EOD
3140.53 1.07428e-08
3150.93 2.62906e-08
3240.27 7.76818e-09
3688 4.89489e-09
5930.4 2.35917e-09
14224.3 6.37232e-10
434422 1.40428e-14
EOD
$series3 << EOD
2392.27 2.64725e-08
2482.67 1.11724e-08
2640.53 7.51829e-09
3194.93 5.14279e-09
5823.73 2.42302e-09
14103.5 6.40561e-10
434423 1.40428e-14
EOD
$series4 << EOD
1876.27 2.80732e-08
2129.87 1.16283e-08
2392.27 8.12688e-09
3040 4.96425e-09
5655.73 2.3988e-09
13857.9 6.19377e-10
434422 1.40428e-14
EOD
$series5 << EOD
1398.4 3.53698e-08
1770.13 1.24923e-08
2047.73 8.43318e-09
2976 5.2187e-09
5745.33 2.33998e-09
13769.1 6.16646e-10
434422 1.40428e-14
EOD
$series6 << EOD
736.533 6.4705e-08
1312.53 1.43971e-08
1754.4 8.7302e-09
2715.2 5.05598e-09
5423.47 2.19695e-09
13542.4 6.16828e-10
434261 1.40428e-14
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title 'p' noenhanced
set title 'Error of the whole mesh against rate, interaction 2, small, basis of 48' noenhanced
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
