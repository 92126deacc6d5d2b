# SPDX-License-Identifier: Apache-2.0
# $forces: time [s], force at the server [N], then at the client for each of delays [ms].
set xrange [0:2.8]
set yrange [0:*]
set xlabel 'time  [s]'
set ylabel 'force  [N]'
set key top right
plot for [i=1:|delays|] $forces using 1:(column(2+i)) with lines linetype i title sprintf('client, %g ms', delays[i]), \
     $forces using 1:2 with lines linetype 7 dashtype 2 title 'server, no delay'
