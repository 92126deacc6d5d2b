#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# tests/viewer/run.sh TACTUS CONFORMANCE WORK: pages of `tactus view` in Chromium. Exits with 77 (skipped) without Chromium or Node.
set -eu
for program in node chromium; do
  command -v "$program" >/dev/null || { echo "skipped: $program not found"; exit 77; }
done
exec node "${0%/*}/test_page.mjs" "$1" chromium "$2" "$3"
