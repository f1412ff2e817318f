#!/usr/bin/env bash
# The unit, property and model tests under the thread sanitizer.
#
#   packaging/ci/tsan.sh              builds and runs all that is worth it: an hour on two cores
#   packaging/ci/tsan.sh -R Session   the tests whose names match
#
# The sanitizer takes what a library does for races unless that library is built for it too: with the distribution's TBB
# each loop is reported. So TBB is built from the distribution's source first (half a minute), where apt-get can get that;
# ISOSLIDER_TSAN_TBB names a folder with such a libtbb.so.12 instead. Nothing is suppressed. VTK has parts of TBB compiled
# into it, so its loops run on one thread.
set -euo pipefail

ROOT=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
readonly ROOT
readonly TBB=$ROOT/build/tsan-tbb

# Every bit, every length, every failing call: of one thread, and minutes long here.
readonly LEFT_OUT='EveryFlippedBit|EveryTruncation|EveryCall|PowerLoss|^Fuzz'

say() { printf 'tsan.sh: %s\n' "$*" >&2; }

# What apt-get reads and writes lies below $TBB; the system's own lists stay as they are.
source_apt() {
  apt-get -q -o Dir::Etc::sourceparts=/dev/null -o Dir::Etc::sourcelist="$TBB/source.sources" \
    -o Dir::State::lists="$TBB/lists" -o APT::Sandbox::User=root "$@"
}

build_tbb() {
  [[ ! -e $TBB/libtbb.so.12 ]] || return 0
  say "building TBB for the sanitizer"
  local sources=/etc/apt/sources.list.d/debian.sources
  [[ -f $sources ]] || sources=$(grep -lE '^Types:' /etc/apt/sources.list.d/*.sources | head -n 1)
  [[ -n $sources ]] || { say "no list of packages to get the source of TBB from; set ISOSLIDER_TSAN_TBB"; exit 1; }
  mkdir -p "$TBB/lists/partial"
  sed -E 's/^Types:.*/Types: deb-src/' "$sources" >"$TBB/source.sources"
  (cd "$TBB" && source_apt update && source_apt source --download-only onetbb && tar xf onetbb_*.orig.tar.*)
  cmake -S "$(echo "$TBB"/oneTBB-*)" -B "$TBB/build" -G Ninja -DTBB_TEST=OFF -DTBB_STRICT=OFF -DTBB_SANITIZE=thread \
    -DTBBMALLOC_BUILD=OFF -DTBB_DISABLE_HWLOC_AUTOMATIC_SEARCH=ON -DCMAKE_BUILD_TYPE=RelWithDebInfo
  cmake --build "$TBB/build"
  cp "$(find "$TBB/build" -name 'libtbb.so.12' | head -n 1)" "$TBB/libtbb.so.12"
}

main() {
  local tbb=${ISOSLIDER_TSAN_TBB:-$TBB}
  [[ -n ${ISOSLIDER_TSAN_TBB:-} ]] || build_tbb
  cd "$ROOT"
  [[ -f build/tsan/build.ninja ]] || cmake --preset tsan -DISOSLIDER_JOINED_BUILD=ON
  # Tests are listed by running them, also while they are built.
  export LD_LIBRARY_PATH=$tbb${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
  cmake --build --preset tsan
  export VTK_SMP_BACKEND_IN_USE=Sequential
  ctest --preset tsan -L '^(unit|property)$' -E "$LEFT_OUT" --parallel "$(nproc)" "$@"
}

main "$@"
