# SPDX-License-Identifier: Apache-2.0
# gnuplot -c c-mse-large.gp svg | png    makes c-mse-large.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11' }
else { set terminal svg size 900,560 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'c-mse-large'.'.'.ARG1 }
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
147078 2.68873e-07
242047 6.63091e-08
292794 3.53773e-08
366348 1.44559e-08
499048 2.87467e-09
659256 2.56425e-10
772304 1.75711e-12
EOD
$series1 << EOD
132126 2.69908e-07
224547 6.66463e-08
274478 3.57991e-08
347162 1.48109e-08
482273 3.03314e-09
652983 2.69337e-10
772304 1.75711e-12
EOD
$series2 << EOD
125242 2.71663e-07
217138 6.80362e-08
267258 3.68028e-08
341935 1.52582e-08
481769 3.04163e-09
652946 2.69408e-10
772304 1.75711e-12
EOD
$series3 << EOD
121275 2.74511e-07
213742 6.94751e-08
264930 3.73908e-08
341304 1.52965e-08
481643 3.04338e-09
652945 2.69484e-10
772304 1.75711e-12
EOD
$series4 << EOD
118563 2.78327e-07
212487 7.00502e-08
264481 3.7455e-08
341142 1.52893e-08
481529 3.04493e-09
652935 2.69501e-10
772304 1.75711e-12
EOD
$series5 << EOD
115987 2.83757e-07
211875 7.01447e-08
263987 3.7518e-08
340896 1.52995e-08
481492 3.04544e-09
652928 2.69515e-10
772304 1.75711e-12
EOD
$series6 << EOD
113357 2.8762e-07
210706 7.04166e-08
263275 3.7599e-08
340567 1.5322e-08
481444 3.0457e-09
652926 2.6953e-10
772304 1.75711e-12
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title 'p' noenhanced
set title 'Error of the whole mesh against rate, interaction 1, large' noenhanced
set xrange [*:*]
set yrange [*:*]
set xlabel 'payload [bit/s]' noenhanced
set ylabel 'MSE [m^2]' noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title '-p 0%' noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title '-p 2.5%' noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title '-p 5%' noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title '-p 7.5%' noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title '-p 10%' noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title '-p 15%' noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title '--haptic off' noenhanced
