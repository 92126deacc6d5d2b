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
0 434380
0.05 55511.2
0.125 50233.3
0.25 49840.3
0.375 50116.5
0.5 50445.6
1 51292.5
EOD
$series1 << EOD
0 434422
0.05 14510.4
0.125 7026.67
0.25 5061.33
0.375 4682.67
0.5 4670.4
1 4870.93
EOD
$series2 << EOD
0 434422
0.05 14224.3
0.125 5930.4
0.25 3688
0.375 3240.27
0.5 3140.53
1 3150.93
EOD
$series3 << EOD
0 434423
0.05 14103.5
0.125 5823.73
0.25 3194.93
0.375 2640.53
0.5 2482.67
1 2392.27
EOD
$series4 << EOD
0 434422
0.05 13857.9
0.125 5655.73
0.25 3040
0.375 2392.27
0.5 2129.87
1 1876.27
EOD
$series5 << EOD
0 434422
0.05 13769.1
0.125 5745.33
0.25 2976
0.375 2047.73
0.5 1770.13
1 1398.4
EOD
$series6 << EOD
0 434261
0.05 13542.4
0.125 5423.47
0.25 2715.2
0.375 1754.4
0.5 1312.53
1 736.533
EOD
set key outside right top title 'p' noenhanced
set title 'Rate over the visual threshold, interaction 2, small, basis of 48' noenhanced
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
