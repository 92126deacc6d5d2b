# SPDX-License-Identifier: Apache-2.0
# $forces: time [s], depths of both devices [mm], then for both users the force without delay and delayed [N].
set multiplot layout 3,1 margins 0.09,0.97,0.09,0.95 spacing 0.02,0.11
set xrange [0:8.5]
set yrange [0:45]
set ylabel 'device  [mm]'
set key top right
set title 'depth of the devices' offset 0,-0.6
plot $forces using 1:2 with lines linetype 1 linewidth 1.3 title 'user 1', \
     $forces using 1:3 with lines linetype 3 dashtype 3 linewidth 1.3 title 'user 2'
set ylabel 'force  [N]'
set yrange [0:*]
set key at graph 0.70, graph 0.96
do for [user=1:2] {
  set title sprintf('user %d, round trip %d ms', user, user == 1 ? 80 : 60) offset 0,-0.6
  if (user == 2) { unset key; set xlabel 'time  [s]' }
  plot $forces using 1:(column(3 + 2 * user)) with lines linetype 2 linewidth 1.3 title 'delayed', \
       $forces using 1:(column(2 + 2 * user)) with lines linetype 7 dashtype 2 linewidth 1.3 title 'no delay'
}
unset multiplot
