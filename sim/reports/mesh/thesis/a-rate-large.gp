# SPDX-License-Identifier: Apache-2.0
# gnuplot -c a-rate-large.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11'; set output 'a-rate-large.png' }
else { set terminal svg size 900,560 font 'sans,13' background 'white'; set output 'a-rate-large.svg' }
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
0 772199
0.05 658669
0.125 498274
0.25 365503
0.375 292017
0.5 241683
1 146739
EOD
$series1 << EOD
0 772199
0.05 652375
0.125 481576
0.25 346184
0.375 273791
0.5 224185
1 131879
EOD
$series2 << EOD
0 772199
0.05 652346
0.125 480921
0.25 340977
0.375 266461
0.5 216802
1 124891
EOD
$series3 << EOD
0 772199
0.05 652327
0.125 480877
0.25 340529
0.375 264353
0.5 213282
1 121129
EOD
$series4 << EOD
0 772199
0.05 652323
0.125 480817
0.25 340250
0.375 263800
0.5 212185
1 118338
EOD
$series5 << EOD
0 772199
0.05 652320
0.125 480713
0.25 340055
0.375 263410
0.5 211449
1 115622
EOD
$series6 << EOD
0 772199
0.05 652313
0.125 480717
0.25 339690
0.375 262620
0.5 210396
1 113059
EOD
set key outside right top title "p" noenhanced
set title "Rate over the visual threshold, interaction 1, large" noenhanced
set xlabel "v [mm]" noenhanced
set ylabel "payload [bit/s]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "-p 0%" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "-p 2.5%" noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title "-p 5%" noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title "-p 7.5%" noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title "-p 10%" noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title "-p 15%" noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title "--haptic off" noenhanced
