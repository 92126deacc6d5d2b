# SPDX-License-Identifier: Apache-2.0
set multiplot layout 2,1 margins 0.09,0.97,0.13,0.97 spacing 0.02,0.06
set xrange [0:4.5]
set format x ''
set ylabel 'force on the hand  [N]'
unset key
plot $force using 1:2 with lines linetype 1
set format x '%g'
set xlabel 'time  [s]'
set ylabel 'position of the cube  [mm]'
set key bottom right reverse Left samplen 1
plot $position using 1:2 with lines linecolor rgb '#999999' linewidth 1.5 title 'position', \
     $visual using 1:2 with points linetype 1 pointtype 4 pointsize 0.7 title 'update: the pose was off', \
     $haptic using 1:2 with points linetype 2 pointtype 7 pointsize 0.5 title 'update: the force was off', \
     $heartbeat using 1:2 with points linetype 3 pointtype 9 pointsize 1.1 title 'update: heartbeat'
unset multiplot
