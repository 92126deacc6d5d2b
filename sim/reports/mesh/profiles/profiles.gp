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
0.025 726993 2.51656e-05 0.000113748 0.000119498
0.05 652307 5.01687e-05 9.6013e-05 0.000100319
0.125 481100 0.000125134 6.6519e-05 6.5007e-05
0.25 345959 0.000250109 4.2413e-05 3.8147e-05
0.5 223752 0.000500122 2.694e-05 2.2293e-05
1 131377 0.00100007 1.7556e-05 1.2268e-05
EOD
$series1 << EOD
0.025 73803.7 2.47129e-05 4.2603e-05 2.7952e-05
0.05 49794.9 4.97674e-05 3.7256e-05 2.4346e-05
0.125 28371.2 0.000124828 3.2698e-05 2.1031e-05
0.25 18876 0.000249795 3.1036e-05 1.9619e-05
0.5 13057.9 0.000499811 3.0085e-05 1.8938e-05
1 9505.87 0.000999772 2.9674e-05 1.9068e-05
EOD
$series2 << EOD
0.025 54161.3 2.47044e-05 6.9854e-05 4.5026e-05
0.05 30985.1 4.97305e-05 6.2813e-05 3.9909e-05
0.125 14427.7 0.000124823 5.7726e-05 3.5113e-05
0.25 8427.2 0.000249705 5.2858e-05 3.0795e-05
0.5 6155.2 0.000499722 5.0284e-05 2.8542e-05
1 5492 0.000999679 4.8051e-05 2.6079e-05
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
