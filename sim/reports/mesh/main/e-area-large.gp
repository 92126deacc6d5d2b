# SPDX-License-Identifier: Apache-2.0
# gnuplot -c e-area-large.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11'; set output 'e-area-large.png' }
else { set terminal svg size 900,560 font 'sans,13' background 'white'; set output 'e-area-large.svg' }
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
67082.4 1.42212e-14
67221.9 1.42212e-14
67831.5 1.42212e-14
67928.8 1.42212e-14
72028.8 1.42212e-14
84787.2 1.42212e-14
584105 1.42212e-14
EOD
$series1 << EOD
5492 9.58207e-09
6155.2 8.76102e-09
6895.47 8.20991e-09
8427.2 7.61203e-09
14427.7 4.52095e-09
30985.1 9.8691e-10
584145 1.42212e-14
EOD
$series2 << EOD
3600.8 2.60578e-08
4552.53 2.18792e-08
5404.27 1.95865e-08
7369.6 1.33313e-08
13632 4.72067e-09
31416.8 1.00191e-09
584145 1.42212e-14
EOD
$series3 << EOD
2959.2 4.10816e-08
4035.2 3.1404e-08
5016.27 2.36039e-08
7318.4 1.34955e-08
13904.5 4.7282e-09
31317.9 1.01153e-09
584145 1.42212e-14
EOD
$series4 << EOD
2464.27 5.62384e-08
3832 3.82811e-08
4846.93 2.46893e-08
7190.93 1.37201e-08
13642.9 4.80225e-09
31327.7 1.01532e-09
584144 1.42212e-14
EOD
$series5 << EOD
2075.2 7.89136e-08
3674.4 3.62792e-08
4770.13 2.47795e-08
7165.33 1.36151e-08
13496.5 4.8838e-09
31176.3 1.01953e-09
584145 1.42212e-14
EOD
$series6 << EOD
1573.87 9.77102e-08
3268 3.81771e-08
4360 2.40549e-08
6752.27 1.39489e-08
13024 4.90852e-09
30825.3 1.02088e-09
583974 1.42212e-14
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title "p" noenhanced
set title "Error of the area of interest against rate, interaction 1, large, basis of 48" noenhanced
set xlabel "payload [bit/s]" noenhanced
set ylabel "MSE in the area [m^2]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "-p 0%" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "-p 2.5%" noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title "-p 5%" noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title "-p 7.5%" noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title "-p 10%" noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title "-p 15%" noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title "--haptic off" noenhanced
