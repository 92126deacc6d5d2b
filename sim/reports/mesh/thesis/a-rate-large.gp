# SPDX-License-Identifier: Apache-2.0
# gnuplot -c a-rate-large.gp svg | png    makes a-rate-large.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11' }
else { set terminal svg size 900,560 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'a-rate-large'.'.'.ARG1 }
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
0 772304
0.05 659256
0.125 499048
0.25 366348
0.375 292794
0.5 242047
1 147078
EOD
$series1 << EOD
0 772304
0.05 652983
0.125 482273
0.25 347162
0.375 274478
0.5 224547
1 132126
EOD
$series2 << EOD
0 772304
0.05 652946
0.125 481769
0.25 341935
0.375 267258
0.5 217138
1 125242
EOD
$series3 << EOD
0 772304
0.05 652945
0.125 481643
0.25 341304
0.375 264930
0.5 213742
1 121275
EOD
$series4 << EOD
0 772304
0.05 652935
0.125 481529
0.25 341142
0.375 264481
0.5 212487
1 118563
EOD
$series5 << EOD
0 772304
0.05 652928
0.125 481492
0.25 340896
0.375 263987
0.5 211875
1 115987
EOD
$series6 << EOD
0 772304
0.05 652926
0.125 481444
0.25 340567
0.375 263275
0.5 210706
1 113357
EOD
set key outside right top title 'p' noenhanced
set title 'Rate over the visual threshold, interaction 1, large' noenhanced
set xrange [*:*]
set yrange [*:*]
set xlabel 'v [mm]' noenhanced
set ylabel 'payload [bit/s]' noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title '-p 0%' noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title '-p 2.5%' noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title '-p 5%' noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title '-p 7.5%' noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title '-p 10%' noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title '-p 15%' noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title '--haptic off' noenhanced
