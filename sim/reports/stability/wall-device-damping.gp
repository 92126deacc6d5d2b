# SPDX-License-Identifier: Apache-2.0
# gnuplot -c wall-device-damping.gp svg | png    makes wall-device-damping.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11' }
else { set terminal svg size 900,560 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'wall-device-damping'.'.'.ARG1 }
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
$damping_1khz << EOD
0.05 100 100 100.016
0.0707107 141.421 141.421 141.455
0.1 200 199.999 200.062
0.141421 282.843 282.839 282.974
0.2 400 399.993 400.278
0.282843 565.685 565.673 566.21
0.4 800 799.978 801.054
0.565685 1131.37 1131.33 1133.48
0.8 1600 1599.94 1604.25
1.13137 2262.74 2262.82 2271.25
1.6 3200 3200.1 3217.09
2.26274 4525.48 4525.6 4559.71
3.2 6400 6400.13 6468.8
4.52548 9050.97 9051.1 9189.53
6.4 12800 12800.1 13079.4
9.05097 18101.9 18102 18664.4
EOD
$damping_60hz << EOD
0.05 6 5.99999 6.01661
0.0707107 8.48528 8.48522 8.51883
0.1 12 11.9999 12.0674
0.141421 16.9706 16.9703 17.105
0.2 24 23.9995 24.2704
0.282843 33.9411 33.9402 34.4838
0.4 48 47.9984 49.0921
0.565685 67.8823 67.8796 70.0825
0.8 96 96.0034 100.46
1.13137 135.765 135.769 144.85
1.6 192 192.005 210.627
2.26274 271.529 271.534 310.15
3.2 384 384.005 465.187
4.52548 543.058 543.063 716.788
6.4 768 768.002 1148.36
9.05097 1086.12 1086.11 1939.56
EOD
set logscale xy
set xlabel 'damping of the device b_d  [N s/m]'
set ylabel 'largest wall stiffness k_o  [N/m]'
set xrange [0.04:12]
set yrange [3:50000]
set format y '10^{%L}'
set key top left reverse Left samplen 2
plot $damping_1khz using 1:2 with lines linetype 1 title 'b_d = k_o T / 2 at 1 kHz', \
     $damping_1khz using 1:3 with points linetype 1 title 'passivity observer, 1 kHz', \
     $damping_1khz using 1:4 with points linetype 1 pointtype 2 pointsize 1 title 'device alone stable, 1 kHz', \
     $damping_60hz using 1:2 with lines linetype 2 title 'b_d = k_o T / 2 at 60 Hz', \
     $damping_60hz using 1:3 with points linetype 2 title 'passivity observer, 60 Hz', \
     $damping_60hz using 1:4 with points linetype 2 pointtype 2 pointsize 1 title 'device alone stable, 60 Hz'
