#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# scenes.sh BUILD_DIR WORK_DIR: an installed program knows the scenes that were installed with it, wherever that is, and no others; the one
# in the build those of the sources.
set -eu
build=$1 work=$2 prefix=$2/prefix
die() { echo "$*"; exit 1; }

rm -rf "$work"
cmake --install "$build" --prefix "$prefix" --component tools >/dev/null
cd "$work"
mv "$prefix" moved
moved/bin/tactus sim push-1dof --duration 10ms -o push.mcap -q
scenes=moved/share/tactus/scenes
mv "$scenes/push-1dof.toml" "$scenes/only-here.toml"
moved/bin/tactus sim only-here --duration 10ms -o here.mcap -q
if moved/bin/tactus sim push-1dof -o push.mcap -q -f 2>refused.txt; then die 'a scene that is not installed is found'; fi
grep -q 'only-here' refused.txt || die 'the names of scenes are not those that are installed'
if grep -q 'push-1dof,' refused.txt; then die 'the names of scenes are of another folder'; fi
"$build/cli/tactus" sim push-1dof --duration 10ms -o again.mcap -q
if "$build/cli/tactus" sim only-here -o again.mcap -q -f 2>refused.txt; then die 'the program in the build looks where another is installed'; fi
