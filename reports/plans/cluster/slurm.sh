#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# A sweep in N parts as an array of Slurm jobs, and a job that merges them:
#   slurm.sh N PLAN -o DIR [OPTION of tactus sweep]...
# All nodes see PLAN and DIR. Options of sbatch are given as its variables: SBATCH_PARTITION=long SBATCH_TIMELIMIT=60 slurm.sh ...
# Parts that failed or ran out of time: the same line again computes what is missing.
set -eu
case $1 in
  part) # of a job of the array
    shift
    exec tactus sweep "$@" -j "${SLURM_CPUS_PER_TASK:-1}" --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT"
    ;;
  merge)
    shift
    exec tactus sweep "$@" --merge
    ;;
esac
parts=$1
shift
job=$(sbatch --parsable --job-name=tactus-sweep --array="1-$parts" "$0" part "$@")
sbatch --parsable --job-name=tactus-merge --dependency="afterok:${job%%;*}" --kill-on-invalid-dep=yes "$0" merge "$@"
