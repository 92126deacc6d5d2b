# SPDX-License-Identifier: Apache-2.0
# gnuplot -c c-mse-large.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11'; set output 'c-mse-large.png' }
else { set terminal svg size 900,560 font 'sans,13' background 'white'; set output 'c-mse-large.svg' }
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
67082.4 1.7534e-08
67221.9 2.51427e-08
67831.5 4.73599e-08
67928.8 1.01805e-08
72028.8 3.69104e-09
84787.2 7.82509e-10
584105 1.35456e-14
EOD
$series1 << EOD
5492 4.87286e-08
6155.2 2.61844e-08
6895.47 1.95821e-08
8427.2 1.08363e-08
14427.7 3.81246e-09
30985.1 8.04116e-10
584145 1.35456e-14
EOD
$series2 << EOD
3600.8 5.08733e-08
4552.53 2.71043e-08
5404.27 1.89128e-08
7369.6 1.08809e-08
13632 3.77903e-09
31416.8 8.11694e-10
584145 1.35456e-14
EOD
$series3 << EOD
2959.2 5.09888e-08
4035.2 2.75675e-08
5016.27 1.80605e-08
7318.4 1.04942e-08
13904.5 3.81814e-09
31317.9 8.13174e-10
584145 1.35456e-14
EOD
$series4 << EOD
2464.27 5.53472e-08
3832 2.75845e-08
4846.93 1.84803e-08
7190.93 1.06969e-08
13642.9 3.72771e-09
31327.7 8.12e-10
584144 1.35456e-14
EOD
$series5 << EOD
2075.2 5.6565e-08
3674.4 2.55703e-08
4770.13 1.80036e-08
7165.33 1.09602e-08
13496.5 3.72827e-09
31176.3 8.12413e-10
584145 1.35456e-14
EOD
$series6 << EOD
1573.87 6.2539e-08
3268 2.58237e-08
4360 1.72229e-08
6752.27 1.06538e-08
13024 3.68294e-09
30825.3 8.07121e-10
583974 1.35456e-14
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title "p" noenhanced
set title "Error of the whole mesh against rate, interaction 1, large, basis of 48" noenhanced
set xlabel "payload [bit/s]" noenhanced
set ylabel "MSE [m^2]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "-p 0%" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "-p 2.5%" noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title "-p 5%" noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title "-p 7.5%" noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title "-p 10%" noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title "-p 15%" noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title "--haptic off" noenhanced
