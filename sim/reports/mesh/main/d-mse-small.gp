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
49678.7 4.62998e-09
49860 6.78565e-09
50543.7 9.74382e-09
50574.7 2.17003e-09
51373.9 2.45442e-08
55394.7 5.82403e-10
433981 1.35038e-14
EOD
$series1 << EOD
4681.33 1.02297e-08
4688.27 6.99066e-09
4887.47 2.5762e-08
5068 4.7635e-09
6984.8 2.2051e-09
14475.7 6.20615e-10
434022 1.35038e-14
EOD
$series2 << EOD
3127.73 9.74951e-09
3140 2.60371e-08
3283.2 7.32945e-09
3778.4 5.07465e-09
6049.33 2.28243e-09
13870.7 6.02727e-10
434021 1.35038e-14
EOD
$series3 << EOD
2382.13 2.63281e-08
2522.67 1.08897e-08
2623.2 7.46283e-09
3248.53 5.34171e-09
5846.67 2.32983e-09
13968.3 6.01609e-10
434019 1.35038e-14
EOD
$series4 << EOD
1904.53 2.89117e-08
2091.2 1.09732e-08
2405.07 8.02471e-09
3016.8 5.28689e-09
5757.6 2.32651e-09
13680 5.96691e-10
434021 1.35038e-14
EOD
$series5 << EOD
1358.4 3.51563e-08
1690.4 1.26121e-08
2090.67 8.31668e-09
2864.27 4.92433e-09
5662.93 2.23212e-09
13789.3 5.98459e-10
434019 1.35038e-14
EOD
$series6 << EOD
733.867 6.3913e-08
1353.07 1.39786e-08
1736.53 8.60012e-09
2672.27 4.70863e-09
5364 2.1357e-09
13446.1 5.93492e-10
433859 1.35038e-14
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
