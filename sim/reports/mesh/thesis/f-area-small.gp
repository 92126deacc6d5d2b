# SPDX-License-Identifier: Apache-2.0
# gnuplot -c f-area-small.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11'; set output 'f-area-small.png' }
else { set terminal svg size 900,560 font 'sans,13' background 'white'; set output 'f-area-small.svg' }
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
88241.6 1.23847e-11
142801 4.58931e-12
175417 2.93988e-12
234127 1.62252e-12
348826 7.34483e-13
511339 4.12377e-13
740967 3.64962e-13
EOD
$series1 << EOD
75340.8 1.19743e-09
129267 1.19663e-09
161100 1.20638e-09
218429 1.21318e-09
331506 1.21256e-09
496376 4.66989e-10
740967 3.64962e-13
EOD
$series2 << EOD
69582.7 6.27558e-09
123132 6.3382e-09
154724 6.32213e-09
212038 5.65492e-09
325927 3.42965e-09
496036 4.90017e-10
740967 3.64962e-13
EOD
$series3 << EOD
66284 1.52436e-08
119518 1.52382e-08
151324 1.4315e-08
208759 1.15875e-08
324997 3.87855e-09
496083 4.92024e-10
740967 3.64962e-13
EOD
$series4 << EOD
64191.2 2.78896e-08
117498 2.58389e-08
149333 2.35617e-08
207201 1.51011e-08
324804 3.91568e-09
495985 4.92373e-10
740967 3.64962e-13
EOD
$series5 << EOD
61522.9 6.18075e-08
115178 4.83757e-08
147586 3.40707e-08
206530 1.6788e-08
324725 3.95777e-09
495970 4.93312e-10
740967 3.64962e-13
EOD
$series6 << EOD
56823.7 2.48195e-07
113235 7.00237e-08
146505 3.96563e-08
206017 1.73903e-08
324597 3.99163e-09
495964 4.94071e-10
740967 3.64962e-13
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title "p" noenhanced
set title "Error of the area of interest against rate, interaction 2, small" noenhanced
set xlabel "payload [bit/s]" noenhanced
set ylabel "MSE in the area [m^2]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "-p 0%" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "-p 2.5%" noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title "-p 5%" noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title "-p 7.5%" noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title "-p 10%" noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title "-p 15%" noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title "--haptic off" noenhanced
