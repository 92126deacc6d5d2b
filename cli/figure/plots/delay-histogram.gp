# SPDX-License-Identifier: Apache-2.0
# $histogram: round trip [ms], share per ms, and that of a gamma distribution. bin: width [ms].
set xlabel 'round trip  [ms]'
set ylabel 'share of the time  [1/ms]'
set xrange [50:130]
set yrange [0:*]
set key top right
set style fill solid 0.35 noborder
plot $histogram using 1:2:(bin * 0.92) with boxes linetype 1 title 'measured', \
     $histogram using 1:3 with lines linetype 7 dashtype 2 linewidth 1.5 title 'gamma distribution'
