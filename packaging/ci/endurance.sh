#!/usr/bin/env bash
# What takes too long for each change: builds that are killed, damage bit by bit, use for an hour.
#
#   packaging/ci/endurance.sh kills [COUNT]     ends builds by SIGKILL at each step, and COUNT times at random moments
#                                               (10000)
#   packaging/ci/endurance.sh flips [COUNT]     COUNT flipped bits of indexes (1000000), every bit of their headers and every
#                                               length, under the address sanitizer
#   packaging/ci/endurance.sh window [FILTER]   the tests of the window under the address sanitizer; FILTER as
#                                               GoogleTest's (all but those that measure time)
#   packaging/ci/endurance.sh soak [MINUTES]    opens, slides, jumps, exports and closes three volumes in turn (60)
#
# Uses build/release, and build/asan-ubsan and build/asan-window for what runs under the sanitizer. ISOSLIDER_SEED
# chooses the moments.
# What differs is printed with its round; the exit code is 1 then.
set -euo pipefail

ROOT=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
readonly ROOT

say() { printf 'endurance.sh: %s\n' "$*" >&2; }

# build PRESET TARGET...
build() {
  local preset=$1
  shift
  [[ -f build/$preset/build.ninja ]] || cmake --preset "$preset" -DISOSLIDER_JOINED_BUILD=ON
  cmake --build "build/$preset" --target "$@"
}

# Five kinds of builds that go on, and one that does not, share the kills.
kills() {
  local count=${1:-10000}
  build release cli_test bad_inputs_test
  export ISOSLIDER_KILLS=$(((count + 5) / 6))
  say "$ISOSLIDER_KILLS kills of each of six builds"
  build/release/bin/cli_test --gtest_brief=1 --gtest_filter='*CliResume.B089*'
  build/release/bin/bad_inputs_test --gtest_brief=1 --gtest_filter='BadIndex.B089*'
}

flips() {
  export ISOSLIDER_FLIPS=${1:-1000000}
  build asan-ubsan core_index_tests
  export ASAN_OPTIONS=strict_string_checks=1 UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
  build/asan-ubsan/bin/core_index_tests --gtest_brief=1 --gtest_filter='*IndexDamage*:LazyLevels*Damaged*'
}

# What libraries leak that are not built here is left out by their names, nothing else. A library that is unloaded before
# the program ends, as drivers are, has no name any more and all it points to counts as leaked: none is unloaded.
window() {
  build asan-window isoslider isoslider_gui_test isoslider_gui_inputs_test
  local keep=$ROOT/build/asan-window/libkeep_loaded.so
  echo 'int dlclose(void* library) { return library == 0; }' | "${CC:-cc}" -shared -fPIC -x c - -o "$keep"
  export ASAN_OPTIONS=quarantine_size_mb=64 # strict checks of strings refuse what libxkbcommon does
  export LSAN_OPTIONS=suppressions=$ROOT/packaging/ci/leaks_of_libraries.txt:print_suppressions=0
  export UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1 QT_QPA_PLATFORM=xcb
  local program failed=0
  for program in isoslider_gui_test isoslider_gui_inputs_test; do
    xvfb-run -a -s '-screen 0 1600x1200x24' env "LD_PRELOAD=$keep" "build/asan-window/bin/$program" --gtest_brief=1 \
      --gtest_filter="${1:--Fluency*:*B107_*}" || failed=1
  done
  return "$failed"
}

soak() {
  build release session_soak
  build/release/bin/session_soak --minutes "${1:-60}"
}

main() {
  cd "$ROOT"
  case "${1:-}" in
    kills | flips | window | soak) "$@" ;;
    *) sed -n '2,/^$/s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"; exit 2 ;;
  esac
}

main "$@"
