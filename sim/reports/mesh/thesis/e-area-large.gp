# SPDX-License-Identifier: Apache-2.0
# gnuplot -c e-area-large.gp svg | png    makes e-area-large.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11' }
else { set terminal svg size 900,560 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'e-area-large'.'.'.ARG1 }
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
147078 1.71761e-11
242047 5.99368e-12
292794 4.11306e-12
366348 2.67148e-12
499048 1.66428e-12
659256 1.40172e-12
772304 1.36893e-12
EOD
$series1 << EOD
132126 6.10159e-09
224547 6.16309e-09
274478 6.20637e-09
347162 6.23679e-09
482273 2.88021e-09
652983 2.39546e-10
772304 1.36893e-12
EOD
$series2 << EOD
125242 3.06117e-08
217138 2.96876e-08
267258 2.56327e-08
341935 1.44978e-08
481769 3.04006e-09
652946 2.41671e-10
772304 1.36893e-12
EOD
$series3 << EOD
121275 7.26191e-08
213742 5.52545e-08
264930 3.53687e-08
341304 1.52637e-08
481643 3.0817e-09
652945 2.41502e-10
772304 1.36893e-12
EOD
$series4 << EOD
118563 1.33477e-07
212487 6.47945e-08
264481 3.68849e-08
341142 1.54368e-08
481529 3.0997e-09
652935 2.41527e-10
772304 1.36893e-12
EOD
$series5 << EOD
115987 2.29536e-07
211875 6.75481e-08
263987 3.77687e-08
340896 1.56078e-08
481492 3.11812e-09
652928 2.41744e-10
772304 1.36893e-12
EOD
$series6 << EOD
113357 2.96141e-07
210706 7.22908e-08
263275 3.94264e-08
340567 1.60373e-08
481444 3.12674e-09
652926 2.42016e-10
772304 1.36893e-12
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title 'p' noenhanced
set title 'Error of the area of interest against rate, interaction 1, large' noenhanced
set xrange [*:*]
set yrange [*:*]
set xlabel 'payload [bit/s]' noenhanced
set ylabel 'MSE in the area [m^2]' noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title '-p 0%' noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title '-p 2.5%' noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title '-p 5%' noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title '-p 7.5%' noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title '-p 10%' noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title '-p 15%' noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title '--haptic off' noenhanced
