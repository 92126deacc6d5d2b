#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# tests/wasm/run.sh PACKAGE CONFORMANCE BUILD_DIR: pack the npm package, install its tarball in BUILD_DIR and use it from there.
# Exits with 77 (skipped) where Node, npm or the pinned packages are not to be had.
set -eu
package=$1 conformance=$2 work=$3
source=$(cd "${0%/*}" && pwd)

skip() { echo "skipped: $*"; exit 77; }

for program in node npm; do
  command -v "$program" >/dev/null || skip "$program not found"
done
mkdir -p "$work"
cp "$source"/*.mjs "$source"/*.js "$source"/*.ts "$source"/*.json "$source/../../examples/decode_stream.mjs" "$work/"
cd "$work"
npm ci --ignore-scripts --no-audit --no-fund >npm.log 2>&1 || skip "npm could not install the packages ($work/npm.log)"
rm -f ./*.tgz
npm pack --silent "$package"
npm install --no-save --offline --ignore-scripts --no-audit --no-fund ./*.tgz >npm.log 2>&1 || { cat npm.log; exit 1; }

node_modules/.bin/tsc --strict --noEmit --target es2022 --module nodenext --lib es2022,dom types_test.ts
node package_test.mjs "$conformance" "$conformance"/vectors/rigid/001-*.tct
for vector in "$conformance"/vectors/rigid/0[0-2]*.tct "$conformance"/vectors/deformable/00*.tct; do
  ! grep -q '"error"' "${vector%.tct}.jsonl" || continue
  node decode_stream.mjs "$vector" "${vector%.tct}.jsonl" >decoded.txt || { echo "$vector: other states"; exit 1; }
done
if node decode_stream.mjs "$conformance"/vectors/rigid/002-*.tct "$conformance"/vectors/rigid/003-*.jsonl >decoded.txt 2>&1; then
  echo 'the states of another vector pass'
  exit 1
fi
