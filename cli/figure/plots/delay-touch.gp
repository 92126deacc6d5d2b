# SPDX-License-Identifier: Apache-2.0
# $touch: time [s], then for each of users the force [N] without delay, delayed, delayed with compensation, the client's stiffness with it
# [N/m], and the round trip [ms]. compensated: 1 if there is any; duration [s].
columns = compensated ? 2 : 1
set multiplot layout |users|,columns margins 0.10,0.98,(|users| > 1 ? 0.105 : 0.18),(|users| > 1 ? 0.90 : 0.83) spacing 0.10,0.15
unset key
set label 1 '━━ delayed' at screen 0.30,0.972 center textcolor linetype 2
if (compensated) { set label 2 '━━ with compensation' at screen 0.52,0.972 center textcolor linetype 1 }
set label 3 '╍╍ no delay' at screen 0.74,0.972 center textcolor linetype 7
set yrange [0:*]
set xrange [0:duration]
do for [i=1:|users|] {
  first = 2 + 5 * (i - 1)
  if (i == |users|) { set xlabel 'time  [s]' } else { unset xlabel }
  set title users[i].': force' noenhanced offset 0,-0.6
  set ylabel 'force  [N]'
  if (i == 2) { unset label }
  if (compensated) {
    plot $touch using 1:(column(first + 1)) with lines linetype 2 linewidth 1.2 notitle, \
         $touch using 1:(column(first + 2)) with lines linetype 1 linewidth 1.2 notitle, \
         $touch using 1:(column(first)) with lines linetype 7 dashtype 2 linewidth 1.4 notitle
    unset label
    set title users[i].': stiffness at the client' noenhanced offset 0,-0.6
    set ylabel 'stiffness  [N/m]'
    plot $touch using 1:(column(first + 3) > 0 ? column(first + 3) : 1/0) with lines linetype 1 linewidth 1.2 notitle
  } else {
    plot $touch using 1:(column(first + 1)) with lines linetype 2 linewidth 1.2 notitle, \
         $touch using 1:(column(first)) with lines linetype 7 dashtype 2 linewidth 1.4 notitle
  }
}
unset multiplot
