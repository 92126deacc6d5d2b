# SPDX-License-Identifier: Apache-2.0
set logscale xy
set xlabel 'damping of the device b_d  [N s/m]'
set ylabel 'largest wall stiffness k_o  [N/m]'
set xrange [0.04:12]
set yrange [3:50000]
set format y '10^{%L}'
set key top left reverse Left samplen 2
plot $damping_1khz using 1:2 with lines linetype 1 title 'b_d = k_o T / 2 at 1 kHz', \
     $damping_1khz using 1:3 with points linetype 1 title 'passivity observer, 1 kHz', \
     $damping_1khz using 1:4 with points linetype 1 pointtype 2 pointsize 1 title 'device alone stable, 1 kHz', \
     $damping_60hz using 1:2 with lines linetype 2 title 'b_d = k_o T / 2 at 60 Hz', \
     $damping_60hz using 1:3 with points linetype 2 title 'passivity observer, 60 Hz', \
     $damping_60hz using 1:4 with points linetype 2 pointtype 2 pointsize 1 title 'device alone stable, 60 Hz'
