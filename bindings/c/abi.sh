#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# The binary interface of the C library against its reference, bindings/c/tactus.abi: exported functions and their version.
#   abi.sh check LIBRARY HEADERS REFERENCE    exit 1 when programs built against the reference would break; 77: no abidiff
#   abi.sh make LIBRARY HEADERS REFERENCE     write the reference anew: a change of it is meant, and bumps the SOVERSION
command -v abidiff > /dev/null || { echo "skipped: no abidiff; apt-get install abigail-tools"; exit 77; }
case "$1" in
  make) exec abidw --headers-dir "$3" --drop-private-types --no-comp-dir-path --no-corpus-path --no-show-locs --out-file "$4" "$2" ;;
  check) exec abidiff --headers-dir1 "$3" --headers-dir2 "$3" --no-added-syms "$4" "$2" ;;
  *) echo "usage: abi.sh check|make LIBRARY HEADERS REFERENCE" >&2; exit 2 ;;
esac
