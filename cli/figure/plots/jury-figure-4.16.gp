# SPDX-License-Identifier: Apache-2.0
set multiplot layout 2,1 margins 0.09,0.97,0.10,0.95 spacing 0.02,0.12
set ylabel 'surface x_o  [mm]'
set xrange [0:800]
set arrow 1 from 320, graph 0 to 320, graph 1 nohead linecolor rgb '#888888' dashtype 2
set label 1 'second user' at 326, graph 0.93 textcolor rgb '#666666'
set yrange [-6:8]
set title '(a) sum of k_s = 720 N/m' offset 0,-0.6
plot $figure_4_16_a using ($1*1e3):2 with steps linetype 2 notitle
set yrange [0:2.2]
set title '(b) sum of k_s = 680 N/m' offset 0,-0.6
set xlabel 'time  [ms]'
plot $figure_4_16_b using ($1*1e3):2 with steps linetype 1 notitle
unset multiplot
