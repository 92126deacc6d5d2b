# SPDX-License-Identifier: Apache-2.0
set logscale xy
set xlabel 'N = T_n / T_s  (deformation every N ms)'
set ylabel 'largest sum of k_s  [N/m]'
set xrange [0.9:60]
set xtics (1,2,3,5,10,20,50)
set format y '10^{%L}'
set arrow from 16.667, graph 0 to 16.667, graph 1 nohead linecolor rgb '#888888' dashtype 2
set label '60 Hz' at 16.1, graph 0.035 right textcolor rgb '#666666'
set key bottom left reverse Left samplen 2
plot $over_n_heavy using 1:2 with lines linetype 3 title 'k_o 1000 N/m, b_o 10 N s/m, m_o 100 g', \
     $over_n_heavy using 1:3 with points linetype 3 notitle, \
     $over_n_figure using 1:2 with lines linetype 1 title 'k_o 100 N/m, b_o 1 N s/m, m_o 10 g (figure 4.16)', \
     $over_n_figure using 1:3 with points linetype 1 notitle, \
     $over_n_linear using 1:2 with lines linetype 2 dashtype 2 title 'the same, surface approached linearly', \
     $over_n_linear using 1:3 with points linetype 2 notitle, \
     $over_n_vertex using 1:2 with lines linetype 4 title 'vertex of the slab alone, 4.5 g', \
     $over_n_vertex using 1:3 with points linetype 4 notitle
