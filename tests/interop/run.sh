#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# tests/interop/run.sh TRACE_TOOL BUILD_DIR: install the pinned packages in BUILD_DIR and run trace_interop.mjs there.
# Exits with 77 (skipped) where Node, npm or the packages are not to be had.
set -eu
tool=$1
work=$2
source=$(cd "${0%/*}" && pwd)

skip() { echo "skipped: $*"; exit 77; }

for program in node npm; do
  command -v "$program" >/dev/null || skip "$program not found"
done
mkdir -p "$work"
cp "$source/package.json" "$source/package-lock.json" "$source/trace_interop.mjs" "$work/"
cd "$work"
if ! cmp -s package-lock.json node_modules/.installed; then
  npm ci --ignore-scripts --no-audit --no-fund >npm.log 2>&1 || skip "npm could not install the packages ($work/npm.log)"
  cp package-lock.json node_modules/.installed
fi
exec node trace_interop.mjs "$tool" "$work"
