# SPDX-License-Identifier: Apache-2.0
set xrange [0.8:1.2]
set yrange [*:*]
set xlabel 'time  [s]'
set ylabel 'normal force  [N]'
set key top right reverse Left samplen 2
plot $forces using 1:2 with lines linetype 1 dashtype 2 linewidth 1.3 title 'at the server', \
     $forces using 1:3 with lines linetype 2 linewidth 1.3 title 'applied at once', \
     $forces using 1:4 with lines linetype 3 linewidth 1.3 title 'linear', \
     $forces using 1:5 with lines linetype 4 linewidth 1.3 title 'Hermite', \
     $forces using 1:6 with lines linetype 5 linewidth 1.3 title 'velocity blending'
