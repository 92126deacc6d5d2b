# SPDX-License-Identifier: Apache-2.0
set multiplot layout 2,1 margins 0.09,0.97,0.13,0.97 spacing 0.02,0.06
set xrange [0.78:1.2]
set yrange [*:*]
set ylabel 'force  [N]'
set key bottom left reverse Left samplen 2
set format x ''
plot $felt_without using 1:2 with lines linetype 2 linewidth 1.3 title 'felt, without interpolation, p = 7.4 %', \
     $server_without using 1:2 with lines linetype 1 dashtype 2 linewidth 1.3 title 'at the server'
set format x '%g'
set xlabel 'time  [s]'
plot $felt_with using 1:2 with lines linetype 2 linewidth 1.3 title 'felt, with interpolation, p = 18.7 %', \
     $server_with using 1:2 with lines linetype 1 dashtype 2 linewidth 1.3 title 'at the server'
unset multiplot
