# SPDX-License-Identifier: Apache-2.0
# A surface in the colours of its local stiffness.
#   heading           text
#   low, high         of the colours [N/m];   marks   between them, "1, 2, 5"
#   bottom, top       of the surface in z [mm]
#   zoom              a flat surface is larger
#   fixed             how many vertices are
#   $faces            patches of four corners, each x, y, z [mm] and stiffness: of a triangle the last one stands twice
#   $held             x, y, z of fixed vertices [mm]
# Viridis: even steps to the eye, readable in grey.
set palette defined (0 '#440154', 1 '#472d7b', 2 '#3b528b', 3 '#2c728e', 4 '#21918c', 5 '#28ae80', 6 '#5ec962', 7 '#addc30', 8 '#fde725')
set pm3d depthorder interpolate 2,2
set logscale cb
set cbrange [low:high]
set view 50, 30, zoom
set view equal xyz
set xyplane relative 0
unset grid
unset border
set lmargin 4
set rmargin 16
set xlabel 'x [mm]' offset 0,-0.5
set ylabel 'y [mm]' offset 1,-0.5
set zlabel 'z [mm]' offset -1,0
set ztics (bottom, top)
set cblabel 'local stiffness [N/m]' offset 1,0
eval 'set cbtics ('.marks.')'
set colorbox user origin screen 0.88, 0.2 size screen 0.022, 0.6
set title heading noenhanced
set key at screen 0.04, 0.08 left bottom Left reverse
if (fixed) {
  splot $faces using 1:2:3:4 with pm3d notitle, \
        $held using 1:2:3 with points pointtype 7 pointsize 1.1 linecolor rgb '#D55E00' title 'fixed'
} else {
  splot $faces using 1:2:3:4 with pm3d notitle
}
