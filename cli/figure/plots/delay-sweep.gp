# SPDX-License-Identifier: Apache-2.0
# $errors: a set per scene: round trip [ms], then for the four kinds of clients the error of the force [%] and the distance at which the
# touched point is seen from its place [mm]. scenes: their names. What lies below an axis is drawn at its lower end.
set multiplot layout |scenes|,2 margins 0.105,0.98,0.055,0.945 spacing 0.125,0.045
unset key
set label 1 '━●━ nothing' at screen 0.17,0.978 center textcolor linetype 2
set label 2 '━■━ softer' at screen 0.36,0.978 center textcolor linetype 3
set label 3 '━▲━ own simulation' at screen 0.58,0.978 center textcolor linetype 1
set label 4 '╍△╍ the same, 10 % off' at screen 0.84,0.978 center textcolor linetype 4
set logscale y
at(v) = v < least ? least : v
set xrange [0:*]
do for [i=1:|scenes|] {
  if (i == |scenes|) { set xlabel 'round trip  [ms]' } else { unset xlabel }
  do for [q=0:1] {
    least = q == 0 ? 0.05 : 0.002
    set yrange [least:(q == 0 ? 1000 : 50)]
    set ylabel (q == 0 ? scenes[i].': force  [%]' : 'seen away  [mm]') noenhanced
    plot $errors index i-1 using 1:(at(column(2 + 4 * q))) with linespoints linetype 2 pointtype 7 pointsize 0.6 notitle, \
         $errors index i-1 using 1:(at(column(3 + 4 * q))) with linespoints linetype 3 pointtype 5 pointsize 0.6 notitle, \
         $errors index i-1 using 1:(at(column(4 + 4 * q))) with linespoints linetype 1 pointtype 9 pointsize 0.8 notitle, \
         $errors index i-1 using 1:(at(column(5 + 4 * q))) with linespoints linetype 4 dashtype 2 pointtype 8 pointsize 0.8 notitle
    unset label
  }
}
unset multiplot
