#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# tests/viewer/run.sh TEST BROWSER TACTUS WORK [CONFORMANCE SESSIONS_WASM]: pages in chromium or firefox-esr. Exits with 77 (skipped) without
# the browser, Node, or the screen that Firefox needs.
set -eu
test=$1 browser=$2 tactus=$3
shift 3
screen=
[ "$browser" = chromium ] || screen=Xvfb
for program in node "$browser" $screen; do
  command -v "$program" >/dev/null || { echo "skipped: $program not found"; exit 77; }
done
exec node "${0%/*}/$test" "$tactus" "$browser" "$@"
