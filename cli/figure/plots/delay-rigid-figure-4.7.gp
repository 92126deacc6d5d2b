# SPDX-License-Identifier: Apache-2.0
# $client: frequency [Hz], impedance [dB of N s/m] without and with compensation; a set per round trip. delays [ms].
set multiplot layout 1,2 margins 0.09,0.97,0.15,0.90 spacing 0.04,0
set logscale x
set xrange [0.1:10]
set yrange [10:50]
set xlabel 'frequency  [Hz]'
set ylabel 'impedance at the client  [dB re 1 N s/m]'
set key top right
set title 'without compensation' offset 0,-0.6
plot for [i=1:|delays|] $client using 1:2 index (i-1) with lines linetype i title sprintf('%g ms', delays[i])
set format y ''
unset ylabel
set title 'with compensation' offset 0,-0.6
plot for [i=1:|delays|] $client using 1:3 index (i-1) with lines linetype i notitle
unset multiplot
