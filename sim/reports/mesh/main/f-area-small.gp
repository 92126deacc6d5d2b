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
49840.3 1.41878e-14
50116.5 1.41878e-14
50233.3 1.41878e-14
50445.6 1.41878e-14
51292.5 1.41878e-14
55511.2 1.41878e-14
434380 1.41878e-14
EOD
$series1 << EOD
4670.4 2.01757e-09
4682.67 1.92126e-09
4870.93 2.18918e-09
5061.33 1.79769e-09
7026.67 1.49972e-09
14510.4 7.42529e-10
434422 1.41878e-14
EOD
$series2 << EOD
3140.53 5.35327e-09
3150.93 6.41225e-09
3240.27 4.74754e-09
3688 4.07027e-09
5930.4 2.69419e-09
14224.3 7.54123e-10
434422 1.41878e-14
EOD
$series3 << EOD
2392.27 1.15384e-08
2482.67 8.33369e-09
2640.53 7.09639e-09
3194.93 5.72425e-09
5823.73 2.98426e-09
14103.5 7.64296e-10
434423 1.41878e-14
EOD
$series4 << EOD
1876.27 1.62175e-08
2129.87 1.09509e-08
2392.27 8.90506e-09
3040 6.33104e-09
5655.73 2.99985e-09
13857.9 7.55422e-10
434422 1.41878e-14
EOD
$series5 << EOD
1398.4 2.73161e-08
1770.13 1.48981e-08
2047.73 1.06994e-08
2976 7.55631e-09
5745.33 2.86139e-09
13769.1 7.53722e-10
434422 1.41878e-14
EOD
$series6 << EOD
736.533 7.5407e-08
1312.53 1.96966e-08
1754.4 1.23797e-08
2715.2 7.71348e-09
5423.47 2.83752e-09
13542.4 7.61144e-10
434261 1.41878e-14
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title 'p' noenhanced
set title 'Error of the area of interest against rate, interaction 2, small, basis of 48' noenhanced
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
