#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# tests/wasm/run.sh PACKAGE CONFORMANCE SESSIONS_WASM BUILD_DIR [C_EXAMPLE]: pack the npm package, install its tarball in BUILD_DIR and use it
# from there; then the sessions' module.
# Exits with 77 (skipped) where Node, npm or the pinned packages are not to be had.
set -eu
package=$1 conformance=$2 sessions=$3 work=$4 c_example=${5-}
source=$(cd "${0%/*}" && pwd)

skip() { echo "skipped: $*"; exit 77; }

for program in node npm; do
  command -v "$program" >/dev/null || skip "$program not found"
done
mkdir -p "$work"
cp "$source"/*.mjs "$source"/*.js "$source"/*.ts "$source"/*.json "$source/../../examples/compare_streams.mjs" "$work/"
cd "$work"
npm ci --ignore-scripts --no-audit --no-fund >npm.log 2>&1 || skip "npm could not install the packages ($work/npm.log)"
rm -f ./*.tgz
npm pack --silent "$package"
npm install --no-save --offline --ignore-scripts --no-audit --no-fund ./*.tgz >npm.log 2>&1 || { cat npm.log; exit 1; }

node_modules/.bin/tsc --strict --noEmit --target es2022 --module nodenext --lib es2022,dom types_test.ts
node package_test.mjs "$conformance" "$conformance"/vectors/rigid/001-*.tct
node sessions_test.mjs "$conformance" "$sessions"

# The example prints what the same program in C prints, and refuses what that refuses.
vectors=$conformance/vectors/rigid
printf 'no stream' >bad.tct
for other in "$vectors"/00[2-9]*.tct; do
  node compare_streams.mjs "$vectors"/001-*.tct "$other" >javascript.txt
  [ -z "$c_example" ] || "$c_example" "$vectors"/001-*.tct "$other" | diff - javascript.txt
done
if grep -q ' 0.000 mm apart' javascript.txt; then echo 'two streams show the same'; exit 1; fi
if node compare_streams.mjs "$other" bad.tct 2>refused.txt; then echo 'no stream is taken for one'; exit 1; fi
grep -q 'bad.tct.*R-STR-1' refused.txt
mesh=$conformance/vectors/deformable/063-closed.tct
if node compare_streams.mjs "$other" "$mesh" 2>refused.txt; then echo 'a mesh alone is taken for a rigid object'; exit 1; fi
grep -q 'no rigid object' refused.txt
