# SPDX-License-Identifier: Apache-2.0
# gnuplot -c profiles.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 900,1280 font 'sans,11'; set output 'profiles.png' }
else { set terminal svg size 900,1280 font 'sans,13' background 'white'; set output 'profiles.svg' }
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
0.025 727034 2.5128e-05 0.000105207 0.000113538
0.05 652375 5.01563e-05 9.4831e-05 0.000100649
0.125 481576 0.000125129 6.6028e-05 6.5216e-05
0.25 346184 0.000250134 4.4206e-05 3.8137e-05
0.5 224185 0.000500106 2.8042e-05 2.2173e-05
1 131879 0.00100009 1.8327e-05 1.2068e-05
EOD
$series1 << EOD
0.025 73916.5 2.4717e-05 4.2232e-05 2.8443e-05
0.05 49840 4.97423e-05 3.6715e-05 2.4517e-05
0.125 28442.9 0.000124842 3.2528e-05 2.1271e-05
0.25 18923.7 0.00024974 3.0545e-05 1.9899e-05
0.5 12972 0.00049981 2.9724e-05 1.9118e-05
1 9517.6 0.000999787 2.9454e-05 1.8618e-05
EOD
$series2 << EOD
0.025 54316.5 2.47149e-05 6.9153e-05 4.5357e-05
0.05 31096.5 4.97399e-05 6.3114e-05 4.02e-05
0.125 14112.8 0.000124803 5.6263e-05 3.4662e-05
0.25 8434.13 0.000249692 5.2548e-05 3.0976e-05
0.5 6171.47 0.000499665 4.9684e-05 2.8192e-05
1 5529.6 0.000999674 4.7892e-05 2.632e-05
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside center top horizontal title "coder" noenhanced
set lmargin 11
set multiplot layout 4,1 title "Both profiles over the visual threshold, interaction 1, p = 2.5 %" noenhanced
set ylabel "payload [bit/s]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "--profile thesis --keep-models" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "--profile main" noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title "--profile main --basis 48" noenhanced
unset key
set ylabel "largest error [m]" noenhanced
plot $series0 using 1:3 with linespoints linetype 1 title "--profile thesis --keep-models" noenhanced, \
     $series1 using 1:3 with linespoints linetype 2 title "--profile main" noenhanced, \
     $series2 using 1:3 with linespoints linetype 3 title "--profile main --basis 48" noenhanced
set ylabel "encode, median [s]" noenhanced
plot $series0 using 1:4 with linespoints linetype 1 title "--profile thesis --keep-models" noenhanced, \
     $series1 using 1:4 with linespoints linetype 2 title "--profile main" noenhanced, \
     $series2 using 1:4 with linespoints linetype 3 title "--profile main --basis 48" noenhanced
set xlabel "v [mm]" noenhanced
set ylabel "decode, median [s]" noenhanced
plot $series0 using 1:5 with linespoints linetype 1 title "--profile thesis --keep-models" noenhanced, \
     $series1 using 1:5 with linespoints linetype 2 title "--profile main" noenhanced, \
     $series2 using 1:5 with linespoints linetype 3 title "--profile main --basis 48" noenhanced
unset multiplot
