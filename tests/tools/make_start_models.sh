#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Make spec/tables/rigid-start-models.csv again: simulate touches, count what their packets hold, write the table.
#   tests/tools/make_start_models.sh BUILD_DIR > spec/tables/rigid-start-models.csv
# Seeds 101..104, so that the seeds 1.. of every evaluation are not among them. Lengths: 0.05 m per unit of the thesis, and 1 m.
set -eu
build=$1
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
for scene in push-1dof rotate-6dof rotate-push-lift; do
  for seed in 101 102 103 104; do
    stream() { # NAME OPTION...
      name=$scene-$seed-$1
      shift
      "$build/cli/tactus" sim "$scene" --seed "$seed" -q -o "$scratch/$name.mcap" --stream "$scratch/$name.tct" "$@" >/dev/null
    }
    for p in 1 4 8 18 30; do stream "p$p" -p "$p%" --visual 0.3mm,2deg; done
    stream visual --haptic off --visual 0.3mm,2deg
    stream coarse -p 4% --visual 6mm,2deg
    stream coarse-visual --haptic off --visual 6mm,2deg
  done
done
"$build/tests/tools/train_start_models" "$scratch"/*.tct
