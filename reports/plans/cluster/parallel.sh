#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# A sweep in N parts with GNU parallel, and then their merge:
#   parallel.sh N PLAN -o DIR [OPTION of tactus sweep]...
# As many parts at a time as there are cores. On other machines that see PLAN and DIR: PARALLEL='-S one,two --workdir .' parallel.sh ...
# Parts that failed: the same line again computes what is missing.
set -eu
parts=$1
shift
seq "$parts" | parallel --quote tactus sweep "$@" -j 1 --shard "{}/$parts"
tactus sweep "$@" --merge
