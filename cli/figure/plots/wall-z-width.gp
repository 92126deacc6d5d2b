# SPDX-License-Identifier: Apache-2.0
set logscale y
set xlabel 'damping of the wall b_o  [N s/m]'
set ylabel 'stiffness of the wall k_o  [N/m]'
set xrange [0:8]
set yrange [100:200000]
set format y '10^{%L}'
set samples 1000
set key bottom right reverse Left samplen 2
T = 1e-3
b_d = 0.35
plot 2*(b_d+x)/T with lines linetype 1 title 'b_d + b_o = k_o T / 2  (slow motion, eq. 2.4)', \
     $z_width using 1:($2 > 0 ? $2 : NaN) with points linetype 1 title 'passive in slow motion, observer', \
     (x < b_d ? 2*(b_d-x)/T : NaN) with lines linetype 2 title 'b_d = k_o T / 2 + b_o  (every motion)', \
     $z_width using 1:($3 > 0 ? $3 : NaN) with points linetype 2 title 'passive at 500 Hz, observer', \
     $z_width using 1:($5 > 0 ? $5 : NaN) with linespoints linetype 3 dashtype 2 title 'stable in a loose grip', \
     $z_width using 1:($4 > 0 ? $4 : NaN) with linespoints linetype 4 dashtype 2 title 'stable, device alone'
