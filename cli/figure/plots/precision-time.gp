# SPDX-License-Identifier: Apache-2.0
# Work over precision: one line for each method, marks at its step sizes.
#   heading, x_label   texts
#   methods            how many;   name[], colour[], dash[], mark[] of each; label[] 1: with its step sizes
#   $data              method behind method: error, seconds of one core per simulated second, step [ms]
set logscale xy
set format x '10^{%L}'
set format y '10^{%L}'
set mxtics 1
set mytics 1
set title heading noenhanced
set xlabel x_label noenhanced
set ylabel 'seconds of one core per simulated second'
set yrange [*:3<*]
set key outside right top Left reverse samplen 2.5
is_1_ms(step) = abs(step - 1) < 1e-6
plot for [i=1:methods] $data index i-1 using 1:2 with linespoints linetype colour[i] dashtype dash[i] pointtype mark[i] pointsize 0.8 \
       title name[i] noenhanced, \
     for [i=1:methods] $data index i-1 using 1:(label[i] ? $2 : NaN):(sprintf('%.3g', $3)) with labels left offset 0.6, 0.35 font ',8' \
       textcolor linetype colour[i] notitle, \
     $data using 1:(is_1_ms($3) ? $2 : NaN) with points pointtype 6 pointsize 1.8 linewidth 1.5 linecolor rgb '#222222' notitle, \
     1 with lines linewidth 1.5 linecolor rgb '#222222' title 'real time; at 1 kHz, 1 ms per step'
