# SPDX-License-Identifier: Apache-2.0
# $forces: time [s], then for both users the force at the server without delay [N], and at the client without compensation, and with it at
# lambda 0.01 and 0.1.
set multiplot layout 2,1 margins 0.09,0.97,0.10,0.95 spacing 0.02,0.10
set xrange [0:8.5]
set yrange [0:*]
set ylabel 'force  [N]'
set key at graph 0.80, graph 0.97 right
set title 'user 1, round trip 80 ms' offset 0,-0.6
plot $forces using 1:3 with lines linetype 2 linewidth 1.3 title 'without compensation', \
     $forces using 1:4 with lines linetype 5 linewidth 1.3 title 'with, λ = 0.01', \
     $forces using 1:5 with lines linetype 1 linewidth 1.3 title 'with, λ = 0.1', \
     $forces using 1:2 with lines linetype 7 dashtype 2 linewidth 1.3 title 'server, no delay'
set title 'user 2, round trip 60 ms' offset 0,-0.6
set xlabel 'time  [s]'
plot $forces using 1:7 with lines linetype 2 linewidth 1.3 notitle, $forces using 1:8 with lines linetype 5 linewidth 1.3 notitle, \
     $forces using 1:9 with lines linetype 1 linewidth 1.3 notitle, $forces using 1:6 with lines linetype 7 dashtype 2 linewidth 1.3 notitle
unset multiplot
