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
0 584105
0.05 84787.2
0.125 72028.8
0.25 67928.8
0.375 67082.4
0.5 67221.9
1 67831.5
EOD
$series1 << EOD
0 584145
0.05 30985.1
0.125 14427.7
0.25 8427.2
0.375 6895.47
0.5 6155.2
1 5492
EOD
$series2 << EOD
0 584145
0.05 31416.8
0.125 13632
0.25 7369.6
0.375 5404.27
0.5 4552.53
1 3600.8
EOD
$series3 << EOD
0 584145
0.05 31317.9
0.125 13904.5
0.25 7318.4
0.375 5016.27
0.5 4035.2
1 2959.2
EOD
$series4 << EOD
0 584144
0.05 31327.7
0.125 13642.9
0.25 7190.93
0.375 4846.93
0.5 3832
1 2464.27
EOD
$series5 << EOD
0 584145
0.05 31176.3
0.125 13496.5
0.25 7165.33
0.375 4770.13
0.5 3674.4
1 2075.2
EOD
$series6 << EOD
0 583974
0.05 30825.3
0.125 13024
0.25 6752.27
0.375 4360
0.5 3268
1 1573.87
EOD
set key outside right top title "p" noenhanced
set title "Rate over the visual threshold, interaction 1, large, basis of 48" noenhanced
set xlabel "v [mm]" noenhanced
set ylabel "payload [bit/s]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "-p 0%" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "-p 2.5%" noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title "-p 5%" noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title "-p 7.5%" noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title "-p 10%" noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title "-p 15%" noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title "--haptic off" noenhanced
