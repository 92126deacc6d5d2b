# SPDX-License-Identifier: Apache-2.0
# In front of every figure stand its data and its settings, then this. Of the settings: width, height [pixels].
set terminal svg size width,height font 'sans,13' background 'white'
set encoding utf8
set datafile missing 'NaN'
set border 3 linecolor rgb '#444444'
set tics nomirror out textcolor rgb '#222222'
set grid linecolor rgb '#d9d9d9' linewidth 0.8 dashtype solid
set key textcolor rgb '#222222' spacing 1.15 samplen 3

# Told apart by everybody (Okabe and Ito): blue, vermilion, green, purple, orange, sky, black. Without colour symbols tell them apart, and
# lines the dashes of dash_of(i), where a figure has lines of equal standing.
array colours[7] = ['#0072B2', '#D55E00', '#009E73', '#CC79A7', '#E69F00', '#56B4E9', '#000000']
array pointtypes[7] = [7, 5, 9, 13, 4, 8, 6]
do for [i=1:7] { set linetype i linecolor rgb colours[i] linewidth 2 pointtype pointtypes[i] pointsize 0.8 }
dash_of(i) = (i - 1) % 5 + 1
