#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# inside.sh apt|dpkg: in the root where the packages are tried. apt fetches what they need; dpkg finds it there already.
# shellcheck disable=SC2086,SC2046 # lists of packages and flags are words
set -eu
cd /srv/tactus-test
step() { echo "== $*"; }
die() { echo "inside.sh: $*" >&2; exit 1; }
has() { dpkg-query -W -f '${Status}' "$1" 2>/dev/null | grep -q 'ok installed'; }
# A root made for containers may leave manuals and documents out: these are looked for in the package itself.
packed() { dpkg-deb --fsys-tarfile ./"$1"_*.deb | tar -xOf - "$2"; } # PACKAGE FILE
names=$(for package in ./*.deb; do dpkg-deb -f "$package" Package; done)

step install $names
case $1 in
  apt)
    export DEBIAN_FRONTEND=noninteractive
    apt-get update -qq
    apt-get install -y -qq --no-install-recommends ./*.deb >install.log 2>&1 || { tail -20 install.log; die 'apt-get install'; }
    if has libtactus-dev; then apt-get install -y -qq --no-install-recommends g++ cmake make pkgconf >>install.log 2>&1; fi
    ;;
  dpkg) dpkg -i ./*.deb >install.log 2>&1 || { cat install.log; die 'dpkg -i: a dependency is not installed here'; } ;;
esac
dpkg -L $names | while read -r path; do [ -d "$path" ] || echo "$path"; done | sort -u >files.txt
echo "$(wc -l <files.txt) files"

if has tactus; then
  step 'the first steps of the README'
  tactus --version
  tactus sim push-1dof -o push.mcap -q
  tactus encode push.mcap -o push.tct -p 4% -q
  tactus decode push.tct -o replica.mcap --like push.mcap -q
  tactus compare push.mcap replica.mcap -p 4% -q
  for page in tactus tactus-encode tactus-import-csv; do packed tactus "./usr/share/man/man1/$page.1.gz" | gzip -t; done
  for completion in bash-completion/completions/tactus zsh/vendor-completions/_tactus fish/vendor_completions.d/tactus.fish; do
    test -s "/usr/share/$completion"
  done
  test -s /usr/share/tactus/plans/deadband.toml
  if [ -e /usr/lib/systemd/system/tactus@.service ]; then
    step 'the service'
    test -s /usr/lib/udev/rules.d/70-tactus.rules
    if command -v systemd-sysusers >/dev/null; then id tactus; fi
    if command -v systemd-analyze >/dev/null; then systemd-analyze verify --man=no 'tactus@push-1dof.service'; fi
    tactus serve push-1dof --check
  fi
fi

if has libtactus-dev; then
  step 'the program in the head of tactus.h, by pkg-config'
  c++ -std=c++20 umbrella.cpp $(pkg-config --cflags --libs tactus-codec) -o umbrella
  ./umbrella
  for component in thesis session seal modes surface fem; do
    pkg-config --exists tactus-$component || continue
    step "a program of the component $component, by pkg-config"
    c++ -std=c++20 "$component.cpp" $(pkg-config --cflags --libs tactus-$component) -o program
    if [ "$component" = surface ]; then ./program corner.obj; else ./program; fi
  done
  step 'a program of the codec, by CMake'
  mkdir tests && mv installed tests/ && cp codec.cpp tests/
  cmake -S tests/installed -B cmake-build -DCOMPONENT=codec >cmake.log || { cat cmake.log; die cmake; }
  cmake --build cmake-build >>cmake.log
  cmake-build/consumer
  for path in README.md LICENSE spec/00-overview.md examples/first/First.cs; do
    dpkg -L libtactus-dev | grep -q "^/usr/share/doc/libtactus-dev/.*$path" || die "$path is not in the package"
  done
fi
if [ -e /usr/include/tactus.h ]; then
  step 'a program in C'
  cc -std=c99 -Wall -Wextra -Wpedantic -Werror c.c $(pkg-config --cflags --libs tactus-c) -o library
  ./library
fi
if has python3-tactus; then
  step 'the Python package'
  dpkg -L python3-tactus | grep -q '/tactus/__init__.py$' || die 'python3-tactus holds no Python: COMPONENT python is missing in its install rules'
  python3 -c 'import tactus; print(tactus.__name__, tactus.__file__)'
fi

step remove
dpkg -P $names >remove.log 2>&1 || { cat remove.log; die 'dpkg -P'; }
left=$(while read -r path; do [ ! -e "$path" ] || echo "$path"; done <files.txt)
left="$left$(find /usr /etc /var/lib -xdev -iname '*tactus*' -not -path '/usr/src/*' -not -path '/var/lib/apt/*')"
[ -z "$left" ] || die "left behind: $left"
echo 'nothing is left'
