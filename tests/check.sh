#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# One check of the project. `./go test` calls those that make up a full test; each builds below build/ and can be run alone.
#   tests/check.sh CHECK
#     debug release test gcc clang asan tsan   build the preset with warnings as errors and run its tests
#     build PRESET | run PRESET           one half of that
#     browser         the page of `tactus view`: build it beside the preset test, open it in chromium
#     codec-only      build the codec without any other package; what links it needs nothing but the C++ run-time library
#     without-thesis  build the program and the testee without component thesis; its vectors are refused as they should be
#     consumer [DIR]  install a build, then build and run projects that use it (DIR: a finished build; else codec-only)
#     conformance     build and run the conformance suite
#     exact [all]     same hashes from g++ -O0 and clang -O3 with the machine's own instructions; all: and the other two of each
#     tidy [FOLDER...]  clang-tidy, over everything but tests/ and examples/ if no folder is named; marks in tests/tidy-passed.txt what passed
#     tidy-changed    clang-tidy of the folders in which a file differs from what passed
#     format          clang-format
#     fuzz SECONDS    every libFuzzer target for so long
#     msan            MemorySanitizer: the codec over all its fuzz corpora, the vectors and the golden motions
#     windows         the codec for Windows: same hashes in Wine, conformance vectors (by hand: g++-mingw-w64-x86-64-posix, wine64)
#     bench           run the benchmarks, JSON into build/bench/
set -eu
cd "$(dirname "$0")/.."
jobs=${TACTUS_JOBS:-$(nproc)}
if [ -z "${CMAKE_GENERATOR-}" ] && command -v ninja >/dev/null; then export CMAKE_GENERATOR=Ninja; fi
# The same file is compiled for several checks: once is enough.
if [ -z "${CMAKE_CXX_COMPILER_LAUNCHER-}" ] && command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_DIR="${CCACHE_DIR:-$PWD/build/ccache}" CCACHE_BASEDIR="$PWD" CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros
fi

die() { echo "tests/check.sh: $*" >&2; exit 1; }

build() { # PRESET [TARGET...]
  cmake --preset "$1"
  preset=$1
  shift
  cmake --build --preset "$preset" -j "$jobs" ${1:+--target "$@"}
}

# Ends with a line `N passed, N failed` of tests: those within a suite of GoogleTest are counted one by one. One more at a time than there are
# cores: some wait for a clock.
run_tests() { # PRESET
  status=0
  results=$PWD/build/results-$1.xml
  ctest --preset "$1" -j $((jobs + 1)) --output-junit "$results" --test-output-size-passed 1000000 || status=$?
  awk '/<testcase / { state = $0; sub(/.* status="/, "", state); sub(/".*/, "", state); ok = bad = 0 }
       /\[  PASSED  \] [0-9]+ test/ { ok = $4 }
       /\[  FAILED  \] [0-9]+ tests?, listed/ { bad = $4 }
       /<skipped/ && !/Unable to find executable/ { state = "skipped" }
       /<\/testcase>/ {
         if (state == "run") passed += ok ? ok : 1
         else if (state != "skipped") { passed += ok; failed += bad ? bad : 1 }
       }
       END { printf "%d passed, %d failed\n", passed, failed }' "$results"
  return $status
}

sources() { find codec session io metrics sim device cli bindings lab examples conformance tests \( -name '*.h' -o -name '*.cpp' -o -name '*.c' \) -print | LC_ALL=C sort; }

# Every installed header must stand alone: it includes what it needs, and only what is installed.
check_headers() { # INCLUDE_DIR
  eigen=$(pkg-config --cflags-only-I eigen3 2>/dev/null) || eigen= # of the component FEM
  (cd "$1" && find . -name '*.h') | while read -r header; do
    # shellcheck disable=SC2086 # a list of words
    echo "#include <tactus/$header>" | "${CXX:-c++}" -std=c++20 -fsyntax-only -I "$1/.." $eigen -x c++ - || die "$header does not stand alone"
  done
  # With what Windows' headers define, unless NOMINMAX is: behind those of others, which undo it.
  # shellcheck disable=SC2086
  (cd "$1" && grep -rhoE '^#include <[A-Za-z_/.]+>' . | grep -v tactus/ | sort -u
    printf '#define %s\n' 'min(a, b) ((a) < (b) ? (a) : (b))' 'max(a, b) ((a) > (b) ? (a) : (b))' near far 'small char' 'ERROR 0'
    find . -name '*.h' | LC_ALL=C sort | sed 's,^\./\(.*\)$,#include <tactus/\1>,') |
    "${CXX:-c++}" -std=c++20 -fsyntax-only -I "$1/.." $eigen -x c++ - || die 'the headers do not agree with one another'
}

# A program of each component that was built, given nothing but the installed files.
consumer() { # BUILD_DIR
  scratch=$1/consumer
  prefix=$scratch/prefix
  scenes=$prefix/share/tactus/scenes
  rm -rf "$scratch"
  cmake --install "$1" --prefix "$prefix" >/dev/null
  check_headers "$prefix/include/tactus"
  for component in codec thesis session seal modes surface fem sim falcon hid c c_trace; do
    installed "$component" || { check_absent "$component"; continue; }
    cmake -S tests/consumer/installed -B "$scratch/$component" -DCOMPONENT="$component" -DCMAKE_PREFIX_PATH="$prefix"
    cmake --build "$scratch/$component"
    set --
    case $component in
      surface) set -- "$scratch/corner.obj" ;;
      sim)
        set -- "$scenes/push-1dof.toml"
        if installed fem && installed surface; then set -- "$@" "$scenes/bracket-and-pad.toml"; fi
        ;;
    esac
    "$scratch/$component/consumer" "$@"
  done
  cmake -S tests/consumer/subproject -B "$scratch/subproject" -DTACTUS_SOURCE="$PWD"
  cmake --build "$scratch/subproject"
  "$scratch/subproject/consumer"
  libraries=$(find "$scratch/subproject" -name 'libtactus*' | wc -l) # the codec's, in `all`
  [ "$libraries" -eq 1 ] || die "a project that contains Tactus builds $libraries libraries of it"
  [ "$(install_rules "$scratch/subproject")" -eq 0 ] || die 'a project that contains Tactus installs it without being asked'
  cmake -S tests/consumer/subproject -B "$scratch/installs" -DTACTUS_SOURCE="$PWD" -DTACTUS_INSTALL=ON >/dev/null
  [ "$(install_rules "$scratch/installs")" -gt 0 ] || die 'a project that contains Tactus cannot install it'
}

install_rules() { # BUILD_DIR
  find "$1" -name cmake_install.cmake -exec cat {} + | grep -c 'file(INSTALL' || true
}

check_absent() { # COMPONENT
  if refused=$(cmake -S tests/consumer/installed -B "$scratch/absent" -DCOMPONENT="$1" -DCMAKE_PREFIX_PATH="$prefix" 2>&1); then die "$1 is found, and is not installed"; fi
  echo "$refused" | tr -s ' \n' ' ' | grep -qE "Component $1 is not in this installation.* -DTACTUS_WITH_[A-Z0-9]+=ON" || die "who wants $1 does not learn how to get it"
  rm -rf "$scratch/absent"
}

installed() { # COMPONENT
  [ -n "$(find "$prefix" -path "*/cmake/tactus/$1.cmake")" ]
}

codec_only() {
  build codec-only
  consumer "$PWD/build/codec-only"
  bindings=$(find build/codec-only/consumer/prefix -name '*.so*' -o -name 'libtactus_session*' -o -path '*/tactus/session/*' -o -name 'libtactus_thesis*' -o -path '*/tactus/thesis/*' -o -name 'tactus_session.h' -o -path '*/tactus/c.cmake' -o -path '*/dist-packages/*')
  [ -z "$bindings" ] || die "the codec alone comes with $bindings"
  needed=$(readelf -d build/codec-only/consumer/codec/consumer | sed -n 's/.*NEEDED.*\[\(.*\)\]/\1/p' | sort | tr '\n' ' ')
  echo "run-time libraries: $needed"
  for library in $needed; do
    case $library in
      libstdc++.so.* | libm.so.* | libgcc_s.so.* | libc.so.*) ;;
      *) die "the codec alone drags in $library" ;;
    esac
  done
}

without_thesis() {
  dir=build/without-thesis
  cmake --preset test -B "$dir" -DTACTUS_WITH_THESIS=OFF -DTACTUS_WITH_TESTS=OFF -DTACTUS_WITH_STUDY=OFF -DTACTUS_WITH_WASM=OFF -DTACTUS_WITH_VIEW=OFF
  cmake --build "$dir" -j "$jobs"
  python3 conformance/run.py --without thesis --testee "$dir/conformance/testee"
}

exact() { # [all]
  for compiler in g++ clang++; do
    for flags in -O0 '-O3 -march=native'; do
      case ${1-}$compiler$flags in
        all* | g++-O0 | clang++-O3*) ;;
        *) continue ;;
      esac
      dir=build/exact/$compiler$(echo "$flags" | tr -d ' ')
      cmake --preset codec-only -B "$dir" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_C_COMPILER="$(echo "$compiler" | sed "s,g++,gcc,; s,clang++,clang,")" -DCMAKE_CXX_FLAGS="$flags" -DCMAKE_BUILD_TYPE=None \
        -DTACTUS_WERROR=OFF -DTACTUS_WITH_THESIS=ON -DTACTUS_WITH_SESSION=ON -DTACTUS_WITH_TESTS=ON >/dev/null
      cmake --build "$dir" --target tactus_golden -j "$jobs" >/dev/null
      "$dir/tests/golden/tactus_golden" >"$dir/hashes.txt"
      diff -u tests/golden/hashes.txt "$dir/hashes.txt" || die "$compiler $flags computes other bits"
      echo "$(wc -l <"$dir/hashes.txt") hashes agree: $compiler $flags"
    done
  done
}

# Without tests/: tests/bench alone takes two minutes of a core, and each `for (auto _ : state)` in it is a finding, as is a leak in the header
# of Google Benchmark.
tidy_tops='codec session io metrics sim device cli bindings conformance'

tidy() { # [FOLDER...]: with what is below each
  # shellcheck disable=SC2086 # a list of words
  [ $# -gt 0 ] || set -- $tidy_tops
  # shellcheck disable=SC2046
  tidy_folders $(source_folders "$@")
}

# tests/tidy-passed.txt keeps what passed, a line `HASH FOLDER` each. What a header of another folder brings, only `tidy` of everything sees.
tidy_changed() {
  # shellcheck disable=SC2046,SC2086
  set -- $(for folder in $(source_folders $tidy_tops); do
    grep -qxF "$(tidy_hash "$folder") $folder" tests/tidy-passed.txt 2>/dev/null || echo "$folder"
  done)
  if [ $# -gt 0 ]; then tidy_folders "$@"; else echo 'no folder differs from what passed'; fi
}

source_folders() { find "$@" \( -name '*.h' -o -name '*.cpp' \) -print | sed 's,/[^/]*$,,' | LC_ALL=C sort -u; }

# Of the rules and of the files right in the folder; needs no git.
tidy_hash() { # FOLDER
  (
    LC_ALL=C
    for file in .clang-tidy "$1"/*.h "$1"/*.cpp; do [ ! -f "$file" ] || sha256sum "$file"; done
  ) | sha256sum | cut -c 1-16
}

# Folders of which this machine builds nothing are named and not marked.
tidy_folders() { # FOLDER...
  cmake --preset clang >/dev/null
  for folder; do
    shift
    if grep -q "\"file\": \"$PWD/$folder/[^/]*\"" build/clang/compile_commands.json; then set -- "$@" "$folder"; else echo "not built here: $folder"; fi
  done
  [ $# -gt 0 ] || return 0
  echo "clang-tidy: $*"
  found=
  run-clang-tidy -quiet -p build/clang -j "$jobs" "^$PWD/($(echo "$*" | tr ' ' '|'))/[^/]*\$" >build/clang/tidy.txt 2>&1 || found=yes
  tidy_mark "$@"
  [ -z "$found" ] || { grep -E '(warning|error):' build/clang/tidy.txt | sort -u; die "clang-tidy has findings; the whole text is in build/clang/tidy.txt"; }
}

# Folders that build/clang/tidy.txt finds nothing in.
tidy_mark() { # FOLDER...
  sed 's/\x1b\[[0-9;]*m//g' build/clang/tidy.txt | sed -n 's/^\(\/[^:]*\):[0-9]*:[0-9]*: \(warning\|error\):.*/\1/p' | sort -u | xargs -r realpath >build/clang/tidy-found.txt
  for folder; do
    if grep -q "^$PWD/$folder/[^/]*\$" build/clang/tidy-found.txt || grep -qv "^$PWD/" build/clang/tidy-found.txt; then continue; fi
    { grep -v " $folder\$" tests/tidy-passed.txt || true; echo "$(tidy_hash "$folder") $folder"; } | LC_ALL=C sort -k 2 >build/clang/tidy-passed.txt
    cp build/clang/tidy-passed.txt tests/tidy-passed.txt
  done
}

# The program and the page of the preset test, with what else a browser needs.
browser() {
  cmake --preset test -DTACTUS_WITH_WASM=ON -DTACTUS_WITH_VIEW=ON
  cmake --build --preset test -j "$jobs" --target all
  run_tests browser
}

fuzz() { # SECONDS
  build fuzz fuzz_programs
  for pack in tests/fuzz/corpus/*.pack; do
    python3 tests/fuzz/pack.py unpack "$pack" "build/fuzz/corpus/$(basename "$pack" .pack)"
  done
  for program in build/fuzz/tests/fuzz/*_fuzz; do
    stem=$(basename "$program" _fuzz)
    dict=tests/fuzz/$stem.dict
    [ -f "$dict" ] || dict=
    echo "== $stem for $1 s"
    # shellcheck disable=SC2046 # a list of folders
    "$program" ${dict:+-dict="$dict"} -max_total_time="$1" -timeout=10 -rss_limit_mb=1024 -print_final_stats=1 -artifact_prefix="build/fuzz/$stem-" \
      "build/fuzz/corpus/$stem" $(sed 's,.*/\(.*\)\.pack$,build/fuzz/corpus/\1,' "build/fuzz/tests/fuzz/$stem.seeds") >"build/fuzz/$stem.log" 2>&1 ||
      { tail -40 "build/fuzz/$stem.log"; die "$stem: add the input to tests/fuzz/corpus/$stem.pack once it is understood"; }
    grep -E '^stat::(number_of_executed_units|peak_rss_mb)' "build/fuzz/$stem.log"
  done
}

# The standard library is not instrumented: programs that only use its headers. The planted fault must be seen.
msan() {
  build msan fuzz_programs tactus_golden
  ctest --preset msan -j "$jobs"
}

# With /usr/include the compiler would read the headers of this system: of tl::expected alone it gets a copy, of GTest, which the two
# programs do not use, the names of its targets.
windows() {
  wine=$(command -v wine64 || echo /usr/lib/wine/wine64)
  [ -x "$wine" ] || die 'windows needs: apt-get install g++-mingw-w64-x86-64-posix wine64'
  dir=$PWD/build/windows
  mkdir -p "$dir/packages/include"
  cp -r /usr/include/tl "$dir/packages/include/"
  echo 'add_library(tl::expected INTERFACE IMPORTED)
target_include_directories(tl::expected INTERFACE ${CMAKE_CURRENT_LIST_DIR}/include)' >"$dir/packages/tl-expected-config.cmake"
  echo 'add_library(GTest::gtest INTERFACE IMPORTED)
add_library(GTest::gtest_main INTERFACE IMPORTED)' >"$dir/packages/GTestConfig.cmake"
  cmake --preset codec-only -B "$dir" --toolchain "$PWD/tests/windows/mingw.cmake" -Dtl-expected_DIR="$dir/packages" \
    -DGTest_DIR="$dir/packages" -DTACTUS_WITH_THESIS=ON -DTACTUS_WITH_SESSION=ON -DTACTUS_WITH_TESTS=ON -DTACTUS_WITH_CONFORMANCE=ON
  cmake --build "$dir" --target tactus_golden testee -j "$jobs"
  export WINEPREFIX="$dir/wine" WINEDEBUG=-all
  "$wine" "$dir/tests/golden/tactus_golden.exe" | tr -d '\r' >"$dir/hashes.txt"
  diff -u tests/golden/hashes.txt "$dir/hashes.txt" || die 'Windows computes other bits'
  echo "$(wc -l <"$dir/hashes.txt") hashes agree: $(x86_64-w64-mingw32-g++-posix --version | head -n 1)"
  python3 conformance/run.py --testee "$wine $dir/conformance/testee.exe"
}

bench() {
  build release
  mkdir -p build/bench
  for program in build/release/tests/bench/*_bench; do
    "$program" --benchmark_out="build/bench/$(basename "$program").json" --benchmark_out_format=json \
      --benchmark_context=commit="$(git describe --always --dirty 2>/dev/null || echo unknown)" \
      --benchmark_context=compiler="$(c++ -dumpfullversion)" --benchmark_context=flags=-O3
  done
}

case ${1-} in
  debug)
    build dev
    run_tests dev
    ;;
  release | test | gcc | clang | asan | tsan)
    build "$1"
    run_tests "$1"
    ;;
  build) build "${2:?which preset?}" ;;
  run) run_tests "${2:?which preset?}" ;;
  codec-only) codec_only ;;
  without-thesis) without_thesis ;;
  consumer)
    [ -n "${2-}" ] || build codec-only
    consumer "${2:-$PWD/build/codec-only}"
    ;;
  conformance)
    build test
    ctest --preset test -R '^conformance'
    ;;
  tidy) "$@" ;;
  tidy-changed) tidy_changed ;;
  exact | browser | msan | windows | bench) "$@" ;;
  format) sources | xargs clang-format --dry-run --Werror ;;
  fuzz) fuzz "${2:?how many seconds?}" ;;
  *)
    sed -n '3,21s/^# \{0,1\}//p' "$0" >&2
    exit 2
    ;;
esac
