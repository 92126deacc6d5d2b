#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# pip.sh PYTHON PACKAGE DIR: pip installs the package of a build without a network into an environment of its own, where it finds its
# libraries, and removes it again. Exits with 77 (skipped) where Python has no NumPy or venv.
set -eu
python=$1 package=$2 dir=$3
unset PYTHONPATH LD_LIBRARY_PATH
if ! why=$("$python" -c 'import numpy, venv, ensurepip' 2>&1); then
  echo "skipped: $(echo "$why" | tail -n 1); apt-get install python3-numpy python3-venv"
  exit 77
fi
rm -rf "$dir"
"$python" -m venv --system-site-packages "$dir"
"$dir/bin/pip" install --quiet --no-index --disable-pip-version-check "$package"
cd "$dir"
bin/python - <<'END'
import pathlib, sys
import tactus
from tactus import _library
assert pathlib.Path(tactus.__file__).is_relative_to(sys.prefix), tactus.__file__
with tactus.build_scene([tactus.RigidObject("cube")]) as scene, tactus.Sender(scene) as sender:
    sender.encode(0, [[0.0] * 3 + [1.0] + [0.0] * 9])
_library.traces()
loaded = {line.split()[-1] for line in open("/proc/self/maps") if "libtactus" in line}
assert len(loaded) == 2 and all(path.startswith(sys.prefix) for path in loaded), loaded
END
bin/pip uninstall --quiet --yes tactus-codec
rm -rf lib/python3*/site-packages/tactus/__pycache__
if bin/python -c 'import importlib.util as u; raise SystemExit(u.find_spec("tactus") is None)'; then echo 'it is still there'; exit 1; fi
[ -z "$(find lib -iname '*tactus*')" ]
# The sources are no package: what is missing is said.
if bin/pip install --no-index "${0%/*}/../../bindings/python" >refused.txt 2>&1; then echo 'pip took the sources'; exit 1; fi
grep -q 'build the target tactus_python' refused.txt
