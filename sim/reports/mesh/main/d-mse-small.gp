# SPDX-License-Identifier: Apache-2.0
# gnuplot -c d-mse-small.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11'; set output 'd-mse-small.png' }
else { set terminal svg size 900,560 font 'sans,13' background 'white'; set output 'd-mse-small.svg' }
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
49772.3 4.51915e-09
50054.7 6.67011e-09
50378.9 2.18854e-09
50414.9 1.00523e-08
51298.4 2.60303e-08
55260.8 5.66965e-10
434091 1.35049e-14
EOD
$series1 << EOD
4611.47 1.00986e-08
4728.53 7.11353e-09
4890.67 2.53238e-08
5044.53 4.86334e-09
6889.6 2.267e-09
14390.4 6.1744e-10
434133 1.35049e-14
EOD
$series2 << EOD
3124 2.53135e-08
3126.4 1.01287e-08
3236 7.07117e-09
3706.4 4.78762e-09
5985.87 2.30281e-09
14270.7 6.21178e-10
434133 1.35049e-14
EOD
$series3 << EOD
2320.27 2.55063e-08
2499.73 1.01519e-08
2622.93 7.83871e-09
3246.67 5.31315e-09
5915.2 2.27252e-09
13726.1 5.92903e-10
434136 1.35049e-14
EOD
$series4 << EOD
1937.6 2.7335e-08
2080.27 1.17058e-08
2302.93 7.93575e-09
3069.6 5.26938e-09
5763.73 2.2605e-09
14048 6.10512e-10
434133 1.35049e-14
EOD
$series5 << EOD
1371.47 3.581e-08
1738.93 1.28244e-08
2085.07 8.15626e-09
2949.33 4.81877e-09
5631.47 2.25143e-09
13972 6.10941e-10
434136 1.35049e-14
EOD
$series6 << EOD
741.333 6.40425e-08
1329.87 1.25791e-08
1729.87 8.52388e-09
2644.27 4.6e-09
5402.4 2.27608e-09
13796.8 6.08213e-10
433968 1.35049e-14
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title "p" noenhanced
set title "Error of the whole mesh against rate, interaction 2, small, basis of 48" noenhanced
set xlabel "payload [bit/s]" noenhanced
set ylabel "MSE [m^2]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "-p 0%" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "-p 2.5%" noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title "-p 5%" noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title "-p 7.5%" noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title "-p 10%" noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title "-p 15%" noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title "--haptic off" noenhanced
