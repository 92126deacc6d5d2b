# SPDX-License-Identifier: Apache-2.0
# names: of the settings; hands: number, then mean and deviation of the scene's hand and of the faster one; thesis: number and rate
set xrange [0.4:|names|+0.6]
set yrange [0:*]
set ylabel 'packets per second'
set xtics scale 0 noenhanced
do for [i=1:|names|] { set xtics add (names[i] i) }
set key top center reverse Left samplen 1
plot $hands using ($1-0.15):2:3 with yerrorbars linetype 1 pointtype 7 title "the scene's hand", \
     $hands using ($1+0.15):4:5 with yerrorbars linetype 2 pointtype 7 title 'a faster hand', \
     $thesis using 1:2 with points linetype 3 pointtype 6 pointsize 1.6 linewidth 1.6 title 'thesis'
