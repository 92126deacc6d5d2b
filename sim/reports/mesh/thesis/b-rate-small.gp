# SPDX-License-Identifier: Apache-2.0
# gnuplot -c b-rate-small.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11'; set output 'b-rate-small.png' }
else { set terminal svg size 900,560 font 'sans,13' background 'white'; set output 'b-rate-small.svg' }
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
0 740967
0.05 511339
0.125 348826
0.25 234127
0.375 175417
0.5 142801
1 88241.6
EOD
$series1 << EOD
0 740967
0.05 496376
0.125 331506
0.25 218429
0.375 161100
0.5 129267
1 75340.8
EOD
$series2 << EOD
0 740967
0.05 496036
0.125 325927
0.25 212038
0.375 154724
0.5 123132
1 69582.7
EOD
$series3 << EOD
0 740967
0.05 496083
0.125 324997
0.25 208759
0.375 151324
0.5 119518
1 66284
EOD
$series4 << EOD
0 740967
0.05 495985
0.125 324804
0.25 207201
0.375 149333
0.5 117498
1 64191.2
EOD
$series5 << EOD
0 740967
0.05 495970
0.125 324725
0.25 206530
0.375 147586
0.5 115178
1 61522.9
EOD
$series6 << EOD
0 740967
0.05 495964
0.125 324597
0.25 206017
0.375 146505
0.5 113235
1 56823.7
EOD
set key outside right top title "p" noenhanced
set title "Rate over the visual threshold, interaction 2, small" noenhanced
set xlabel "v [mm]" noenhanced
set ylabel "payload [bit/s]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "-p 0%" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "-p 2.5%" noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title "-p 5%" noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title "-p 7.5%" noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title "-p 10%" noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title "-p 15%" noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title "--haptic off" noenhanced
