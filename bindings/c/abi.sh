#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The binary interface of libtactus.so against its reference, tactus.abi: exported functions, their types and structs.
#   abi.sh check LIBRARY    exit 1 when it differs: programs built before may break; 77: there is no abidiff
#   abi.sh make LIBRARY     write the reference anew. A change that breaks programs bumps the SOVERSION as well
here=$(cd "$(dirname "$0")" && pwd)
command -v abidiff > /dev/null || { echo "skipped: no abidiff; apt-get install abigail-tools"; exit 77; }
describe() { # LIBRARY OUT
  abidw --header-file "$here/tactus.h" --header-file "$here/tactus_session.h" --drop-private-types --exported-interfaces-only \
    --no-comp-dir-path --no-corpus-path --no-show-locs --out-file "$2" "$1"
}
case "$1" in
  make) describe "$2" "$here/tactus.abi" ;;
  check)
    now=$(mktemp)
    trap 'rm -f "$now"' EXIT
    describe "$2" "$now" && abidiff "$here/tactus.abi" "$now" || { echo "an intended change: bindings/c/abi.sh make $2"; exit 1; } ;;
  *) echo "usage: abi.sh check|make LIBRARY" >&2; exit 2 ;;
esac
