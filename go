#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Installs missing packages, builds and runs Tactus on Debian 12. Needs root or sudo only to install packages.
#   ./go demo     simulate a touch, encode, decode and compare; report and figure in out/demo/ (5 minutes on 2 cores)
#   ./go view     the same, and a page that shows it in a browser, out/demo/stream.html (2 minutes and 500 MB more)
#   ./go test     build with g++ and test: codec, library, program, Python, fuzz corpora, conformance (12 minutes on 2 cores)
#   ./go test all       and with sanitizers, other compilers, clang-tidy of what changed, a browser (an hour)
#   ./go test nightly   what is left: packages, mutants, other builds, fuzzing, Slurm, an emulated machine (hours)
#   ./go bench    build and run the benchmarks; JSON in build/bench/
#   ./go devices  capture a device of the kernel's own making in an emulated machine, from /dev/uhid to the trace (30 s after the build)
#   ./go site     write the documentation as one static site: examples, libraries, specification, reports (30 s)
#   ./go format   format the sources with clang-format
# shellcheck disable=SC2086 # lists of packages are words
set -eu
cd "$(dirname "$0")"
PATH=/usr/bin:$PATH # the Python whose packages are installed below

demo_packages='g++ cmake ninja-build pkgconf libexpected-dev libzstd-dev liblz4-dev libode-dev libtomlplusplus-dev libcli11-dev nlohmann-json3-dev libfmt-dev python3 python3-numpy python3-matplotlib'
build_packages="$demo_packages libgnutls28-dev libeigen3-dev libsuitesparse-dev libspectra-dev libusb-1.0-0-dev libhidapi-dev libboost-dev"
bench_packages='libbenchmark-dev libgtest-dev python3 libbullet-dev'
view_packages='nodejs clang-16 lld-16 binaryen wasi-libc libc++-16-dev-wasm32 libc++abi-16-dev-wasm32 libclang-rt-16-dev-wasm32 python3'
site_packages='python3 doxygen cmark-gfm'
test_packages='libgtest-dev python3-pytest git tetgen zstd lz4 xz-utils bzip2'
all_packages='ccache clang libclang-rt-dev clang-tidy clang-format chromium mono-mcs mono-runtime'
nightly_packages="$bench_packages $site_packages munge parallel slurm-wlm tshark umockdev libumockdev-dev valgrind firefox-esr xvfb abigail-tools python3-venv
  mandoc groff-base bsdextrautils zsh fish lintian dpkg-dev make openssl qemu-system-x86 linux-image-amd64 busybox-static cpio kmod"

bounds='-p 4% --visual 0.3mm,2deg' # of the demo
with_view=                         # a build that has the page of `tactus view` keeps it

die() { echo "$*" >&2; exit 2; }

as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi
}

install() { # PACKAGE...
  missing=
  for package in "$@"; do
    dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing="$missing $package"
  done
  [ -n "$missing" ] || return 0
  step "install$missing" apt_install
}

apt_install() {
  as_root apt-get update && as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $missing
}

# Why the demo does without them: on a machine that has none of them they take 110 s to install, 70 of which are npm's, and the demo would
# take half as long again. Some packages of Node bring npm, others refuse the package npm.
install_view_tools() {
  install $view_packages
  command -v npm >/dev/null || install npm
}

# Run a command quietly and show its progress on a terminal. If it fails, show the end of its log and how to run it again.
step() { # TITLE COMMAND...
  title=$1
  shift
  mkdir -p build/log
  log=build/log/$(echo "$title" | tr -c 'a-z0-9+\n' '-' | cut -c 1-40).log
  begin=$(date +%s)
  printf '%s ... ' "$title"
  "$@" >"$log" 2>&1 &
  running=$!
  [ ! -t 1 ] || progress "$running" "$log"
  if wait "$running"; then
    echo "ok ($(($(date +%s) - begin)) s)"
  else
    echo FAILED
    tail -n 40 "$log"
    printf '\nThis step failed: %s\nFull log: %s\nRun it again with: %s\n' "$title" "$log" "$*"
    total
    exit 1
  fi
}

# While the process runs, show the newest [3/286] of its log after the cursor.
progress() { # PID LOG
  while kill -0 "$1" 2>/dev/null; do
    at=$(tail -c 4000 "$2" 2>/dev/null | grep -o '^\[[0-9]*/[0-9]*\]' | tail -n 1)
    printf '\033[s%-12s\033[u' "$at"
    sleep 0.5
  done
  printf '\033[K'
}

run_test() { # [all | nightly]
  case ${1-} in
    '' | all) ;;
    nightly)
      run_nightly
      return
      ;;
    *) die "go: no such test: $1 (all, nightly or nothing)" ;;
  esac
  rm -f build/log/*.log
  install $build_packages $test_packages
  step 'g++: build' tests/check.sh build test
  step 'g++: tests' tests/check.sh run test
  [ -z "${1-}" ] || run_all
  total
}

run_all() {
  install $all_packages
  install_view_tools
  step 'g++: second implementation, studies' tests/check.sh run rest
  step 'clang: build with AddressSanitizer and UndefinedBehaviorSanitizer' tests/check.sh build asan
  step 'sanitizers: tests' tests/check.sh run asan
  step 'codec alone: no package needed, nothing else linked' tests/check.sh codec-only
  step 'same bits: g++ -O0, clang -O3 -march=native' tests/check.sh exact
  step 'clang-format' tests/check.sh format
  step 'clang-tidy of changed folders' tests/check.sh tidy-changed
  step 'page of tactus view in chromium' tests/check.sh browser
}

run_nightly() {
  rm -f build/log/*.log
  install $build_packages $test_packages $all_packages $nightly_packages
  install_view_tools
  step 'g++: build each file on its own, without warnings' tests/check.sh build gcc
  step 'g++: all tests, also those that build or test a test' tests/check.sh run gcc
  step 'without component thesis' tests/check.sh without-thesis
  step 'codec: MemorySanitizer over all fuzz corpora' tests/check.sh msan
  step 'same bits from both compilers, without and with optimisation' tests/check.sh exact all
  step 'libFuzzer: 30 s for each reader' tests/check.sh fuzz 30
  step 'clang-tidy of everything' tests/check.sh tidy
  step 'a device of the emulated kernel' tests/qemu/run.py build/gcc/cli/tactus build/gcc/tests/qemu/uhid_device build/qemu
  total
}

total() {
  cat build/log/*.log | awk '/^[0-9]+ passed, [0-9]+ failed$/ { passed += $1; failed += $3 } END { if (passed + failed) printf "%d passed, %d failed\n", passed, failed }'
}

# Everything that apt serves, several files as one compilation; without the page of `tactus view`, whose tools take two minutes more.
build_demo() {
  cmake -S . -B build/demo -G Ninja -DCMAKE_BUILD_TYPE=Release -DTACTUS_UNITY=20 -DTACTUS_WITH_CLI=ON -DTACTUS_WITH_SIM=ON -DTACTUS_WITH_FEM=ON \
    -DTACTUS_WITH_SURFACE=ON -DTACTUS_WITH_SEAL=ON -DTACTUS_WITH_NET=ON -DTACTUS_WITH_DEVICE=ON $with_view \
    -DTACTUS_WITH_C=OFF -DTACTUS_WITH_CONFORMANCE=OFF -DTACTUS_WITH_TESTS=OFF &&
    cmake --build build/demo
}

run_demo() {
  install $build_packages
  step 'build the codec, the simulator and the program' build_demo
  out=out/demo
  tactus=build/demo/cli/tactus
  mkdir -p "$out"
  step 'simulate a hand that turns, pushes and lifts a cube' "$tactus" sim rotate-push-lift -o "$out/truth.mcap" -f
  step 'encode the trace into a stream' "$tactus" encode "$out/truth.mcap" -o "$out/stream.tct" -f $bounds
  step 'decode the stream as a client does' "$tactus" decode "$out/stream.tct" -o "$out/replica.mcap" --like "$out/truth.mcap" -f
  rm -rf "$out/sweep" # of an earlier build
  step 'draw packet rate and error over the deadband' "$tactus" sweep reports/plans/demo.toml -o "$out/sweep"
  "$tactus" encode "$out/truth.mcap" -o "$out/stream.tct" -f $bounds | tee "$out/report.txt"
  "$tactus" encode "$out/truth.mcap" -o "$out/stream.tct" -f $bounds --json >"$out/encode.json"
  held='every bound held at every tick'
  "$tactus" compare "$out/truth.mcap" "$out/replica.mcap" --json >"$out/compare.json" || held='a bound was BROKEN, see compare.json'
  if "$tactus" view "$out/stream.tct" --truth "$out/truth.mcap" -o "$out/stream.html" -f -q 2>/dev/null; then
    see="$out/stream.html in a browser: cube, hand, forces, packets and errors over time, decoded by the page itself"
  else
    see='./go view: the same as a page for a browser, which needs 500 MB of tools'
  fi
  cat <<END

Result at the decoder: $held.
See       $see
Look at   $out/sweep/deadband.svg: packet rate and error of the force over the deadband
          $out/truth.mcap, $out/replica.mcap in Foxglove or PlotJuggler
Reports   $out/report.txt, encode.json, compare.json, sweep/points.csv
Next      PATH=\$PWD/build/demo/cli:\$PATH; tactus --help
          tactus sim push-1dof -o push.mcap; tactus encode push.mcap -o push.tct -p 8%
END
  [ "$held" = 'every bound held at every tick' ]
}

run_view() {
  install_view_tools
  with_view=-DTACTUS_WITH_VIEW=ON
  run_demo
}

run_bench() {
  install $build_packages $bench_packages
  tests/check.sh bench
}

build_devices() {
  cmake --preset gcc -G Ninja && cmake --build build/gcc --target tactus uhid_device
}

run_devices() {
  install $build_packages $bench_packages qemu-system-x86 linux-image-amd64 busybox-static cpio kmod
  step 'build the program and the device' build_devices
  tests/qemu/run.py build/gcc/cli/tactus build/gcc/tests/qemu/uhid_device build/qemu
}

run_site() {
  install $site_packages
  step 'write the site and check its links' tools/site/make_site.py out/site
  echo "Open $PWD/out/site/index.html"
}

run_format() {
  install clang-format
  find codec session io metrics sim device cli conformance tests \( -name '*.h' -o -name '*.cpp' \) -exec clang-format -i {} +
}

case ${1-help} in
  test)
    shift
    run_test "$@"
    ;;
  demo | view | bench | devices | site | format) "run_$1" ;;
  help | -h | --help) sed -n '3,12s/^# \{0,1\}//p' "$0" ;;
  *) die "go: no such command: $1 (try ./go help)" ;;
esac
