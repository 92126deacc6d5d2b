# SPDX-License-Identifier: Apache-2.0
# A recording over its time: panels one below the other.
#   heading
#   panels              at least 1;  y_label[], y_range[] ("[low:high]"), bound[] (NaN: none) of each
#   time_end            [s]
#   first[], lines[]    of each panel: lines before its own, and how many it has
#   name[]              of each line
#   $data               line behind line: time [s], value
set key at graph 1,1.03 right bottom horizontal noenhanced samplen 3
set xrange [0:time_end]
set multiplot layout panels,1 title heading noenhanced margins screen 0.1,0.97,(72.0/height),(1 - 66.0/height) spacing screen (44.0/height)
do for [panel=1:panels] {
  if (panel == panels) { set format x '%g'; set xlabel 'time [s]' } else { set format x '' }
  set ylabel y_label[panel] noenhanced
  eval 'set yrange '.y_range[panel]
  from = first[panel] + 1
  to = first[panel] + lines[panel]
  if (lines[panel] == 1 && bound[panel] != bound[panel]) { unset key } else { set key }
  if (bound[panel] == bound[panel]) {
    plot for [i=from:to] $data index i-1 using 1:2 with lines linetype i-from+1 dashtype dash_of(i-from+1) linewidth (i == from ? 1.8 : 1.4) title name[i] noenhanced, \
         bound[panel] with lines linecolor rgb '#444444' linewidth 1.2 dashtype 3 title 'bound'
  } else {
    plot for [i=from:to] $data index i-1 using 1:2 with lines linetype i-from+1 dashtype dash_of(i-from+1) linewidth (i == from ? 1.8 : 1.4) title name[i] noenhanced
  }
}
unset multiplot
