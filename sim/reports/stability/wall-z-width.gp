# SPDX-License-Identifier: Apache-2.0
# gnuplot -c wall-z-width.gp svg | png    makes wall-z-width.svg or .png; a third word `-`: to standard output
if (ARG1 eq 'png') { set terminal pngcairo size 900,560 font 'sans,11' }
else { set terminal svg size 900,560 font 'sans,13' background 'white' }
if (ARG2 ne '-') { set output 'wall-z-width'.'.'.ARG1 }
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
$z_width << EOD
0 699.988 699.988 700.819 25047.5
0.05 799.852 600.036 800.168 25140.7
0.1 899.696 500.043 899.269 25232.3
0.15 999.521 400.088 998.179 25326.2
0.2 1099.42 300.092 1096.9 25418.5
0.25 1199.21 200.125 1195.42 25513.1
0.3 1299.09 100.151 1293.76 25606
0.5 1698.47 0 1685.1 25977.1
0.75 2197.77 0 2169.97 26439.1
1 2696.92 0 2649.79 26900.8
1.25 3196.3 0 3124.85 27359.8
1.5 3695.58 0 3595.3 27817.8
1.75 4194.85 0 4060.75 28274.5
2 4693.94 0 4521.66 28729.6
2.25 5193.36 0 4977.9 29182.9
2.5 5692.57 0 5429.29 29633.9
2.75 6191.61 0 5875.91 30084.7
3 6690.88 0 6318.19 30535.2
3.25 7190.52 0 6756.26 30982.6
3.5 7689.68 0 7189.38 31426.6
3.75 8188.46 0 7618.28 31871.9
4 8687.95 0 8042.19 32313.4
4.25 9187.35 0 8462.22 32755.7
4.5 9686.31 0 8877.48 33196.3
4.75 10185.8 0 9288.86 33634.8
5 10684.8 0 9695.5 34071
5.25 11184.3 0 10098.4 34507.4
5.5 11683.2 0 10496.4 34941.1
5.75 12183.1 0 10890.3 35371.9
6 12682.3 0 11280.2 35805.2
6.25 13181.1 0 11665.6 36232.3
6.5 13680 0 12047.1 36661.6
6.75 14179.9 0 12424.3 37087.1
7 14679.5 0 12798.1 37511.7
7.25 15178.7 0 13167.5 37938.2
7.5 15677.5 0 13532.7 38360.4
7.75 16177.3 0 13893.7 38781.2
8 16675.9 0 14250.7 39200.4
EOD
set logscale y
set xlabel 'damping of the wall b_o  [N s/m]'
set ylabel 'stiffness of the wall k_o  [N/m]'
set xrange [0:8]
set yrange [100:200000]
set format y '10^{%L}'
set samples 1000
set key bottom right reverse Left samplen 2
T = 1e-3
b_d = 0.35
plot 2*(b_d+x)/T with lines linetype 1 title 'b_d + b_o = k_o T / 2  (slow motion, eq. 2.4)', \
     $z_width using 1:($2 > 0 ? $2 : NaN) with points linetype 1 title 'passive in slow motion, observer', \
     (x < b_d ? 2*(b_d-x)/T : NaN) with lines linetype 2 title 'b_d = k_o T / 2 + b_o  (every motion)', \
     $z_width using 1:($3 > 0 ? $3 : NaN) with points linetype 2 title 'passive at 500 Hz, observer', \
     $z_width using 1:($5 > 0 ? $5 : NaN) with linespoints linetype 3 dashtype 2 title 'stable in a loose grip', \
     $z_width using 1:($4 > 0 ? $4 : NaN) with linespoints linetype 4 dashtype 2 title 'stable, device alone'
