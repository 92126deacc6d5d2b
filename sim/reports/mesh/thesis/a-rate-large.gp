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
0 772102
0.05 658617
0.125 497859
0.25 365126
0.375 291691
0.5 241204
1 146288
EOD
$series1 << EOD
0 772102
0.05 652307
0.125 481100
0.25 345959
0.375 273416
0.5 223752
1 131377
EOD
$series2 << EOD
0 772102
0.05 652268
0.125 480579
0.25 340696
0.375 266087
0.5 216301
1 124379
EOD
$series3 << EOD
0 772102
0.05 652198
0.125 480487
0.25 340116
0.375 263949
0.5 212854
1 120416
EOD
$series4 << EOD
0 772102
0.05 652191
0.125 480397
0.25 339814
0.375 263408
0.5 211691
1 117963
EOD
$series5 << EOD
0 772102
0.05 652192
0.125 480323
0.25 339657
0.375 262867
0.5 211004
1 115144
EOD
$series6 << EOD
0 772102
0.05 652191
0.125 480243
0.25 339272
0.375 262183
0.5 209947
1 112662
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
