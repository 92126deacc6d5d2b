# SPDX-License-Identifier: Apache-2.0
# gnuplot -c d-mse-small.gp svg | png
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11'; set output 'd-mse-small.png' }
else { set terminal svg size 900,560 font 'sans,13' background 'white'; set output 'd-mse-small.svg' }
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
88241.6 2.33304e-07
142801 6.29061e-08
175417 3.58635e-08
234127 1.53353e-08
348826 3.37751e-09
511339 3.98889e-10
740967 5.5459e-13
EOD
$series1 << EOD
75340.8 2.33192e-07
129267 6.30287e-08
161100 3.58904e-08
218429 1.54128e-08
331506 3.43784e-09
496376 4.21752e-10
740967 5.5459e-13
EOD
$series2 << EOD
69582.7 2.33883e-07
123132 6.34181e-08
154724 3.61831e-08
212038 1.56452e-08
325927 3.55083e-09
496036 4.2311e-10
740967 5.5459e-13
EOD
$series3 << EOD
66284 2.34571e-07
119518 6.39105e-08
151324 3.6614e-08
208759 1.59802e-08
324997 3.57281e-09
496083 4.22708e-10
740967 5.5459e-13
EOD
$series4 << EOD
64191.2 2.35302e-07
117498 6.44572e-08
149333 3.7072e-08
207201 1.61642e-08
324804 3.57383e-09
495985 4.22809e-10
740967 5.5459e-13
EOD
$series5 << EOD
61522.9 2.37362e-07
115178 6.55818e-08
147586 3.76479e-08
206530 1.62203e-08
324725 3.57634e-09
495970 4.22865e-10
740967 5.5459e-13
EOD
$series6 << EOD
56823.7 2.46863e-07
113235 6.67534e-08
146505 3.79045e-08
206017 1.62635e-08
324597 3.57736e-09
495964 4.22921e-10
740967 5.5459e-13
EOD
set logscale x
set format x '10^{%L}'
set logscale y
set format y '10^{%L}'
set key outside right top title "p" noenhanced
set title "Error of the whole mesh against rate, interaction 2, small" noenhanced
set xlabel "payload [bit/s]" noenhanced
set ylabel "MSE [m^2]" noenhanced
plot $series0 using 1:2 with linespoints linetype 1 title "-p 0%" noenhanced, \
     $series1 using 1:2 with linespoints linetype 2 title "-p 2.5%" noenhanced, \
     $series2 using 1:2 with linespoints linetype 3 title "-p 5%" noenhanced, \
     $series3 using 1:2 with linespoints linetype 4 title "-p 7.5%" noenhanced, \
     $series4 using 1:2 with linespoints linetype 5 title "-p 10%" noenhanced, \
     $series5 using 1:2 with linespoints linetype 6 title "-p 15%" noenhanced, \
     $series6 using 1:2 with linespoints linetype 7 title "--haptic off" noenhanced
