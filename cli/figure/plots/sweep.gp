# SPDX-License-Identifier: Apache-2.0
# A figure of a sweep: one panel for each y below the other, one line for each series.
#   heading, x_label, x_range, series_label   texts; a range is "[low:high]"
#   log_x, log_y        1: logarithmic, 2: also with numbers at 2 and 5
#   marked              1: at every point; 0: lines alone
#   spread              1: bars from the least to the largest of the repetitions
#   panels              at least 1;   y_label[], y_range[] of each
#   series              how many;     name[] of each
#   $data               series behind series: x, then middle, least and largest of each panel
if (log_x) { set logscale x; set format x '%h' }
if (log_y) { set logscale y; set format y '%h' }
do for [power=-12:12] { do for [digit in '2 5'] {
  at = digit*10.0**power
  if (log_x == 2) { set xtics add (sprintf('%g', at) at) }
  if (log_y == 2) { set ytics add (sprintf('%g', at) at) }
} }
if (panels == 1) {
  set key outside right top title series_label noenhanced
  set title heading noenhanced
} else {
  set key outside center top horizontal title series_label noenhanced
  set lmargin 12
  set multiplot layout panels,1 title heading noenhanced
}
if (series == 1) { unset key }
eval 'set xrange '.x_range
do for [panel=1:panels] {
  if (panel == 2) { unset key }
  if (panel == panels) { set xlabel x_label noenhanced }
  set ylabel y_label[panel] noenhanced
  eval 'set yrange '.y_range[panel]
  y = 3*panel - 1
  if (series == 0) { plot NaN notitle }
  if (series > 0 && !marked) {
    plot for [i=1:series] $data index i-1 using 1:y with lines linetype i dashtype dash_of(i) title name[i] noenhanced
  }
  if (series > 0 && marked && !spread) {
    plot for [i=1:series] $data index i-1 using 1:y with linespoints linetype i dashtype dash_of(i) title name[i] noenhanced
  }
  if (series > 0 && marked && spread) {
    plot for [i=1:series] $data index i-1 using 1:y:y+1:y+2 with yerrorbars linetype i dashtype solid linewidth 1 notitle, \
         for [i=1:series] $data index i-1 using 1:y with linespoints linetype i dashtype dash_of(i) title name[i] noenhanced
  }
}
if (panels > 1) { unset multiplot }
