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
49678.7 1.41495e-14
49860 1.41495e-14
50543.7 1.41495e-14
50574.7 1.41495e-14
51373.9 1.41495e-14
55394.7 1.41495e-14
433981 1.41495e-14
EOD
$series1 << EOD
4681.33 2.02835e-09
4688.27 1.90982e-09
4887.47 2.20304e-09
5068 1.78202e-09
6984.8 1.46813e-09
14475.7 7.36445e-10
434022 1.41495e-14
EOD
$series2 << EOD
3127.73 5.12784e-09
3140 6.52582e-09
3283.2 4.82947e-09
3778.4 4.25528e-09
6049.33 2.58734e-09
13870.7 7.58634e-10
434021 1.41495e-14
EOD
$series3 << EOD
2382.13 1.1528e-08
2522.67 8.3737e-09
2623.2 7.15121e-09
3248.53 5.75507e-09
5846.67 2.95507e-09
13968.3 7.37017e-10
434019 1.41495e-14
EOD
$series4 << EOD
1904.53 1.64812e-08
2091.2 1.10229e-08
2405.07 8.81342e-09
3016.8 6.88656e-09
5757.6 2.88801e-09
13680 7.48705e-10
434021 1.41495e-14
EOD
$series5 << EOD
1358.4 2.74272e-08
1690.4 1.52474e-08
2090.67 1.10433e-08
2864.27 7.4196e-09
5662.93 2.95285e-09
13789.3 7.55032e-10
434019 1.41495e-14
EOD
$series6 << EOD
733.867 7.69516e-08
1353.07 2.05276e-08
1736.53 1.23558e-08
2672.27 7.67799e-09
5364 2.93435e-09
13446.1 7.50468e-10
433859 1.41495e-14
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
