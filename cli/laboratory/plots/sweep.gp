# SPDX-License-Identifier: Apache-2.0
# A figure of a sweep: one panel for each y below the other, one line for each series.
#   heading, x_label, x_range, series_label   texts; a range is "[low:high]"
#   log_x, log_y        1: logarithmic
#   panels              at least 1;   y_label[], y_range[] of each
#   series              how many;     name[] of each
#   $data               series behind series: x, y of each panel
if (log_x) { set logscale x; set format x '10^{%L}' }
if (log_y) { set logscale y; set format y '10^{%L}' }
if (panels == 1) {
  set key outside right top title series_label noenhanced
  set title heading noenhanced
} else {
  set key outside center top horizontal title series_label noenhanced
  set lmargin 11
  set multiplot layout panels,1 title heading noenhanced
}
eval 'set xrange '.x_range
do for [panel=1:panels] {
  if (panel == 2) { unset key }
  if (panel == panels) { set xlabel x_label noenhanced }
  set ylabel y_label[panel] noenhanced
  eval 'set yrange '.y_range[panel]
  if (series == 0) {
    plot NaN notitle
  } else {
    plot for [i=1:series] $data index i-1 using 1:panel+1 with linespoints linetype i title name[i] noenhanced
  }
}
if (panels > 1) { unset multiplot }
