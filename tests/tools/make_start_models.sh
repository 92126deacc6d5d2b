#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Make a table of start models again: simulate touches, count what their packets hold, write the table.
#   tests/tools/make_start_models.sh rigid BUILD_DIR > spec/tables/rigid-start-models.csv
#   tests/tools/make_start_models.sh deformable BUILD_DIR > spec/tables/deformable-start-models.csv
# Seeds 101.., so that the seeds 1.. of every evaluation are not among them. Lengths of rigid scenes: 0.05 m per unit of the thesis,
# and 1 m.
set -eu
stem=$1
build=$2
tactus=$build/cli/tactus
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

rigid_streams() {
  stream() { # NAME OPTION...
    name=$1
    shift
    "$tactus" sim "$scene" --seed "$seed" -q -o "$scratch/$scene-$seed-$name.mcap" --stream "$scratch/$scene-$seed-$name.tct" \
      "$@" >/dev/null
  }
  for p in 1 4 8 18 30; do stream "p$p" -p "$p%" --visual 0.3mm,2deg; done
  stream visual --haptic off --visual 0.3mm,2deg
  stream coarse -p 4% --visual 6mm,2deg
  stream coarse-visual --haptic off --visual 6mm,2deg
  stream thesis -p 4% --visual 0.3mm,2deg --profile thesis
  for p in 4 30; do
    "$tactus" encode "$scratch/$scene-$seed-p$p.mcap" -q -o "$scratch/$scene-$seed-p$p-motion.tct" -p "$p%" --visual 0.3mm,2deg \
      --tune gravity=9.81,friction=0.7 >/dev/null
  done
}

deformable_streams() {
  trace=$scratch/$scene-$seed.mcap
  "$tactus" sim "$scene" --seed "$seed" -q -o "$trace" >/dev/null
  stream() { # NAME OPTION...
    name=$1
    shift
    "$tactus" encode "$trace" -q -o "$scratch/$scene-$seed-$name.tct" "$@" >/dev/null
  }
  for basis in 0 48; do
    for v in 0.05 0.125 0.25 0.5 1; do
      for p in 2.5 10; do stream "v$v-p$p-k$basis" --deformable-visual "${v}mm" -p "$p%" --basis "$basis"; done
      stream "v$v-k$basis" --deformable-visual "${v}mm" --haptic off --basis "$basis"
    done
  done
  stream fine --deformable-visual 0.01mm --haptic off
  for basis in 0 48; do
    for v in 0.125 0.25 0.5; do
      for p in 2.5 10; do stream "layered-v$v-p$p-k$basis" --tune layered=on --deformable-visual "${v}mm" -p "$p%" --basis "$basis"; done
      stream "nuggets-v$v-k$basis" --tune nugget=all --deformable-visual "${v}mm" --basis "$basis"
    done
  done
}

case $stem in
  rigid) scenes="push-1dof rotate-6dof rotate-push-lift" seeds="101 102 103 104" ;;
  deformable) scenes="membrane membrane-light" seeds="101 102" ;;
  *)
    echo "make_start_models.sh: $stem: neither rigid nor deformable" >&2
    exit 2
    ;;
esac
for scene in $scenes; do
  for seed in $seeds; do "${stem}_streams"; done
done
"$build/tests/tools/train_${stem}_start_models" "$scratch"/*.tct
