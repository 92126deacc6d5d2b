#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# A sweep in N parts with GNU parallel, and then their merge:
#   parallel.sh N PLAN -o DIR [OPTION of tactus sweep]...
# As many parts at a time as there are cores. On other machines that see PLAN and DIR: PARALLEL='-S one,two --workdir .' parallel.sh ...
# Parts that failed: the same line again computes what is missing.
set -eu
parts=$1
shift
# Each line is a whole command: in the words of its own command GNU parallel runs {= what stands in such brackets =}.
line='tactus sweep'
for word in "$@"; do line="$line '$(printf '%s\n' "$word" | sed "s/'/'\\\\''/g")'"; done
seq "$parts" | while read -r part; do printf '%s\0' "$line -j 1 --shard $part/$parts"; done | parallel -0
tactus sweep "$@" --merge
