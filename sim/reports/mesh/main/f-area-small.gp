# SPDX-License-Identifier: Apache-2.0
# gnuplot -c f-area-small.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11'; set output 'f-area-small.png' }
else { set terminal svg size 900,560 font 'sans,13' background 'white'; set output 'f-area-small.svg' }
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
49772.3 1.42008e-14
50054.7 1.42008e-14
50378.9 1.42008e-14
50414.9 1.42008e-14
51298.4 1.42008e-14
55260.8 1.42008e-14
434091 1.42008e-14
EOD
$series1 << EOD
4611.47 1.97576e-09
4728.53 1.92475e-09
4890.67 2.20342e-09
5044.53 1.81576e-09
6889.6 1.48731e-09
14390.4 7.60694e-10
434133 1.42008e-14
EOD
$series2 << EOD
3124 6.54685e-09
3126.4 5.36386e-09
3236 4.66279e-09
3706.4 4.03379e-09
5985.87 2.59102e-09
14270.7 7.43751e-10
434133 1.42008e-14
EOD
$series3 << EOD
2320.27 1.10957e-08
2499.73 8.07245e-09
2622.93 7.14634e-09
3246.67 5.63668e-09
5915.2 2.89013e-09
13726.1 7.68242e-10
434136 1.42008e-14
EOD
$series4 << EOD
1937.6 1.63598e-08
2080.27 1.0968e-08
2302.93 9.10307e-09
3069.6 7.12464e-09
5763.73 2.84413e-09
14048 7.61537e-10
434133 1.42008e-14
EOD
$series5 << EOD
1371.47 2.78731e-08
1738.93 1.50273e-08
2085.07 1.09046e-08
2949.33 7.39557e-09
5631.47 2.89836e-09
13972 7.60014e-10
434136 1.42008e-14
EOD
$series6 << EOD
741.333 7.22373e-08
1329.87 1.96875e-08
1729.87 1.21544e-08
2644.27 7.37709e-09
5402.4 2.96193e-09
13796.8 7.63547e-10
433968 1.42008e-14
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title "p" noenhanced
set title "Error of the area of interest against rate, interaction 2, small, basis of 48" noenhanced
set xlabel "payload [bit/s]" noenhanced
set ylabel "MSE in the area [m^2]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "-p 0%" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "-p 2.5%" noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title "-p 5%" noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title "-p 7.5%" noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title "-p 10%" noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title "-p 15%" noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title "--haptic off" noenhanced
