#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# tests/viewer/run.sh TEST TACTUS WORK [CONFORMANCE SESSIONS_WASM]: pages in Chromium. Exits with 77 (skipped) without Chromium or Node.
set -eu
for program in node chromium; do
  command -v "$program" >/dev/null || { echo "skipped: $program not found"; exit 77; }
done
test=$1 tactus=$2
shift 2
exec node "${0%/*}/$test" "$tactus" chromium "$@"
