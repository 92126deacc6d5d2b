# SPDX-License-Identifier: Apache-2.0
# $forces: time [s], force [N] of one user without delay, then for each of delays [ms] without and with compensation.
set multiplot layout 1,2 margins 0.095,0.98,0.17,0.88 spacing 0.11,0.1
set xlabel 'time  [s]'
set ylabel 'force  [N]'
set yrange [0:*]
set key bottom right
set title 'without compensation' offset 0,-0.6
plot for [i=|delays|:1:-1] $forces using 1:(column(1+2*i)) with lines linetype i linewidth 1.2 title sprintf('%g ms', delays[i]), \
     $forces using 1:2 with lines linetype 7 dashtype 2 linewidth 1.4 title 'no delay'
set title 'with compensation' offset 0,-0.6
plot for [i=|delays|:1:-1] $forces using 1:(column(2+2*i)) with lines linetype i linewidth 1.2 title sprintf('%g ms', delays[i]), \
     $forces using 1:2 with lines linetype 7 dashtype 2 linewidth 1.4 title 'no delay'
unset multiplot
