# SPDX-License-Identifier: Apache-2.0
# $client: frequency [Hz], impedance [dB of N s/m] exact and approximated; a set per round trip. $server: frequency, dB. delays [ms].
set logscale x
set xrange [0.1:10]
set yrange [10:50]
set xlabel 'frequency  [Hz]'
set ylabel 'impedance  [dB re 1 N s/m]'
set key top right
set arrow 1 from 0.5, graph 0 to 0.5, graph 1 nohead linecolor rgb '#888888' dashtype 3
plot for [i=1:|delays|] $client using 1:2 index (i-1) with lines linetype i title sprintf('client, %g ms', delays[i]), \
     for [i=1:|delays|] $client using 1:3 index (i-1) with lines linetype i linewidth 1 dashtype 4 notitle, \
     $server using 1:2 with lines linetype 7 dashtype 2 title 'server', \
     NaN with lines linetype 7 linewidth 1 dashtype 4 title 'with {K_i} for K_i(s)'
