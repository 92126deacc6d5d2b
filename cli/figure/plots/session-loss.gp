# SPDX-License-Identifier: Apache-2.0
set xlabel 'datagrams lost, each way  [%]'
set ylabel 'ticks with a bound broken  [%]'
set xrange [0:52]
set yrange [0:*]
set key top left reverse Left samplen 2
plot $plain using 1:2 with linespoints linetype 1 title 'each for itself', \
     $jitter using 1:2 with linespoints linetype 2 dashtype 2 pointtype 5 title 'with jitter up to 30 ms', \
     $bursts using 1:2 with linespoints linetype 3 dashtype 3 pointtype 9 title 'in bursts of 5 on average'
