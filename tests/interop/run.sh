#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# tests/interop/run.sh SCRIPT PROGRAM BUILD_DIR: install the pinned packages in BUILD_DIR and run the script there on the program.
# Exits with 77 (skipped) where Node, npm or the packages are not to be had.
set -eu
script=$1
program=$2
work=$3
source=$(cd "${0%/*}" && pwd)

skip() { echo "skipped: $*"; exit 77; }

for needed in node npm; do
  command -v "$needed" >/dev/null || skip "$needed not found"
done
mkdir -p "$work"
cp "$source/package.json" "$source/package-lock.json" "$source/$script" "$work/"
cd "$work"
if ! cmp -s package-lock.json node_modules/.installed; then
  npm ci --ignore-scripts --no-audit --no-fund >npm.log 2>&1 || skip "npm could not install the packages ($work/npm.log)"
  cp package-lock.json node_modules/.installed
fi
exec node "$script" "$program" "$work"
