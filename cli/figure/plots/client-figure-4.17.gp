# SPDX-License-Identifier: Apache-2.0
set multiplot layout 5,2 margins 0.075,0.985,0.055,0.97 spacing 0.085,0.04
set xrange [0:4]
unset key
text = "'(a) barely held, no delay' '(b) barely held, 100 ms' '(c) barely held, 100 ms, b_c = 5 N s/m' \
'(d) normal grip, 100 ms' '(e) barely held, 100 ms, k_o = 1000 N/m'"
do for [i=1:5] {
  name = word('a b c d e', i)
  set title word(text, i) offset 0,-0.7
  if (i == 5) { set xlabel 'time  [s]'; set format x '%g' } else { set format x '' }
  set ylabel 'force  [N]'
  set yrange [0:*]
  eval 'plot $'.name.' using 1:2 with lines linewidth 1.3 linetype '.(i == 2 ? '2' : '1')
  set title ' '
  set ylabel 'energy  [mJ]'
  set yrange [*:*]
  set arrow 1 from 0,0 to 4,0 nohead linecolor rgb '#888888' back
  eval 'plot $'.name.' using 1:3 with lines linewidth 1.3 linetype '.(i == 2 ? '2' : '1')
  unset arrow 1
}
unset multiplot
