#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The binary interface of libtactus.so and libtactus-trace.so against their references, tactus.abi and tactus-trace.abi: exported
# functions, their types and structs.
#   abi.sh check LIBRARY    exit 1 when it differs: programs built before may break; 77: there is no abidiff
#   abi.sh make LIBRARY     write the reference anew. A change that breaks programs bumps the SOVERSION as well
here=$(cd "$(dirname "$0")" && pwd)
command -v abidiff > /dev/null || { echo "skipped: no abidiff; apt-get install abigail-tools"; exit 77; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/public"
cp "$here"/tactus*.h "$scratch/public" # what other headers define is not part of the interface
describe() { # LIBRARY OUT
  abidw --headers-dir "$scratch/public" --drop-private-types --exported-interfaces-only --no-comp-dir-path --no-corpus-path --no-show-locs \
    --out-file "$2" "$1"
}
reference=$here/$(basename "${2:-}" | sed 's/^lib//; s/\.so.*//').abi
case "$1" in
  make) describe "$2" "$reference" ;;
  check)
    describe "$2" "$scratch/now.abi" && abidiff "$reference" "$scratch/now.abi" ||
      { echo "an intended change: bindings/c/abi.sh make $2"; exit 1; } ;;
  *) echo "usage: abi.sh check|make LIBRARY" >&2; exit 2 ;;
esac
