# SPDX-License-Identifier: Apache-2.0
# gnuplot -c profiles.gp svg | png    makes profiles.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 900,1280 font 'sans,11' }
else { set terminal svg size 900,1280 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'profiles'.'.'.ARG1 }
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
0.025 727490 2.51312e-05 0.000108451 0.000116955
0.05 652983 5.01266e-05 9.9357e-05 0.000103234
0.125 482273 0.000125131 6.8982e-05 6.6178e-05
0.25 347162 0.000250129 4.4456e-05 3.9128e-05
0.5 224547 0.000500115 2.8132e-05 2.2804e-05
1 132126 0.00100014 1.8608e-05 1.2629e-05
EOD
$series1 << EOD
0.025 73814.4 2.47198e-05 4.2894e-05 2.8042e-05
0.05 49977.3 4.9751e-05 3.8097e-05 2.4637e-05
0.125 28484.5 0.000124836 3.3701e-05 2.1181e-05
0.25 18960.5 0.000249748 3.1327e-05 1.9749e-05
0.5 13168 0.000499891 3.0325e-05 1.9028e-05
1 9416.53 0.000999759 2.9795e-05 1.8467e-05
EOD
$series2 << EOD
0.025 54436.8 2.47136e-05 6.9994e-05 4.4727e-05
0.05 31490.9 4.97361e-05 6.3024e-05 3.969e-05
0.125 14254.9 0.000124818 5.6534e-05 3.3951e-05
0.25 8594.93 0.000249722 5.3039e-05 3.0976e-05
0.5 6165.87 0.000499752 5.0225e-05 2.8472e-05
1 5461.33 0.000999723 4.8191e-05 2.6159e-05
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside center top horizontal title 'coder' noenhanced
set lmargin 11
set multiplot layout 4,1 title 'Both profiles over the visual threshold, interaction 1, p = 2.5 %' noenhanced
set xrange [*:*]
set yrange [*:*]
set ylabel 'payload [bit/s]' noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title '--profile thesis --keep-models' noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title '--profile main' noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title '--profile main --basis 48' noenhanced
set yrange [*:*]
unset key
set ylabel 'largest error [m]' noenhanced
plot $series0 using 1:3 with linespoints linetype 1 title '--profile thesis --keep-models' noenhanced, \
     $series1 using 1:3 with linespoints linetype 2 title '--profile main' noenhanced, \
     $series2 using 1:3 with linespoints linetype 3 title '--profile main --basis 48' noenhanced
set yrange [*:*]
set ylabel 'encode, median [s]' noenhanced
plot $series0 using 1:4 with linespoints linetype 1 title '--profile thesis --keep-models' noenhanced, \
     $series1 using 1:4 with linespoints linetype 2 title '--profile main' noenhanced, \
     $series2 using 1:4 with linespoints linetype 3 title '--profile main --basis 48' noenhanced
set yrange [*:*]
set xlabel 'v [mm]' noenhanced
set ylabel 'decode, median [s]' noenhanced
plot $series0 using 1:5 with linespoints linetype 1 title '--profile thesis --keep-models' noenhanced, \
     $series1 using 1:5 with linespoints linetype 2 title '--profile main' noenhanced, \
     $series2 using 1:5 with linespoints linetype 3 title '--profile main --basis 48' noenhanced
unset multiplot
