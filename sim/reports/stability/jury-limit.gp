# SPDX-License-Identifier: Apache-2.0
# gnuplot -c jury-limit.gp svg | png    makes jury-limit.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11' }
else { set terminal svg size 900,560 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'jury-limit'.'.'.ARG1 }
set encoding utf8
set datafile missing 'NaN'
set border 3 linecolor rgb '#444444'
set tics nomirror out textcolor rgb '#222222'
set grid linecolor rgb '#d9d9d9' linewidth 0.6 dashtype solid
set key textcolor rgb '#222222' spacing 1.15
set linetype 1 linecolor rgb '#0072B2' linewidth 2 pointtype 7 pointsize 0.7
set linetype 2 linecolor rgb '#D55E00' linewidth 2 pointtype 7 pointsize 0.7
set linetype 3 linecolor rgb '#009E73' linewidth 2 pointtype 7 pointsize 0.7
set linetype 4 linecolor rgb '#CC79A7' linewidth 2 pointtype 7 pointsize 0.7
set linetype 5 linecolor rgb '#E69F00' linewidth 2 pointtype 7 pointsize 0.7
set linetype 6 linecolor rgb '#56B4E9' linewidth 2 pointtype 7 pointsize 0.7
set linetype 7 linecolor rgb '#000000' linewidth 2 pointtype 7 pointsize 0.7
$over_n_figure << EOD
1 42100 42099.4
2 11100 11100.2
3 5211.11 5211.46
5 2100 2100.21
7 1202.04 1202.24
10 700 700.129
14 446.939 447.078
20 300 300.102
30 211.111 211.201
50 156 156.086
EOD
$over_n_linear << EOD
1 42100 42099.4
2 2400 2417.94
3 1300 1306.73
5 750 752.529
7 566.667 568.181
10 444.444 445.417
14 369.231 369.919
20 315.789 316.319
30 275.862 276.291
50 244.898 245.261
EOD
$over_n_heavy << EOD
1 421000 421021
2 111000 110999
3 52111.1 52113.6
5 21000 21001.7
7 12020.4 12022.1
10 7000 7001.15
14 4469.39 4470.69
20 3000 3001.21
30 2111.11 2112.15
50 1560 1560.96
EOD
$over_n_vertex << EOD
1 17927.2 17926.7
2 4481.79 4481.67
3 1991.91 1991.86
5 717.087 717.096
7 365.861 365.873
10 179.272 179.274
14 91.4652 91.4682
20 44.8179 44.8185
30 19.9191 19.9194
50 7.17087 7.17064
EOD
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
