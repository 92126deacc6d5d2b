#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Run tests of the Python package; 77 (skipped) where it has no NumPy or pytest:  python.sh PYTHON FILE...
if ! why=$("$1" -c 'import numpy, pytest' 2>&1); then
  echo "skipped: $(echo "$why" | tail -1); apt-get install python3-numpy python3-pytest"
  exit 77
fi
python=$1
shift
exec "$python" -m pytest -q -p no:cacheprovider "$@"
