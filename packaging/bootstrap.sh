#!/usr/bin/env bash
# From a bare Debian 12 to a running ISOSLIDER, or to its tests, without a question asked.
#
#   packaging/bootstrap.sh run [FILE]       install, build, open the window on FILE or a sample
#   packaging/bootstrap.sh test [--quick] [--again]   install, build, run every test
#
# Works from any folder, as root or with sudo. What is there already is not done again.
set -euo pipefail

readonly PROGRAM=${0##*/}
ROOT=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
readonly ROOT
readonly PACKAGE_LIST=$ROOT/packaging/debian-packages.txt
readonly SAMPLE=$ROOT/resources/samples/bluntfinxyz.bin
# ccache wants a home, which a bare container may not have.
[[ -n ${HOME:-} ]] || export CCACHE_DIR=$ROOT/build/ccache
readonly WINDOW_SIZE=1600x1000
# What one compiler needs at its worst, with the headers of VTK.
readonly MEMORY_PER_JOB_KIB=$((1536 * 1024))

say() { printf '%s: %s\n' "$PROGRAM" "$*" >&2; }
fail() { say "$@"; exit 1; }

usage() {
  cat <<TEXT
usage: $PROGRAM run [FILE]       build, and open the window on FILE or on the Blunt Fin sample
       $PROGRAM test [--quick] [--again]
                                 build, and run every test that has not passed on these files yet;
                                 --quick leaves out the sanitizer and fuzzing builds, --again runs all
TEXT
}

# --- packages ---------------------------------------------------------------------------------------

wanted_packages() { sed -e 's/#.*//' -e 's/[[:space:]]//g' -e '/^$/d' "$PACKAGE_LIST"; }

missing_packages() {
  local installed
  # dpkg-query fails when it does not know a name; what it prints of the others still counts.
  # shellcheck disable=SC2046
  installed=$(dpkg-query -W -f='${db:Status-Status} ${Package}\n' $(wanted_packages) 2>/dev/null |
    sed -n 's/^installed //p') || true
  comm -23 <(wanted_packages | sort -u) <(sort -u <<<"$installed")
}

as_root() {
  if [[ $(id -u) -eq 0 ]]; then
    env DEBIAN_FRONTEND=noninteractive "$@" </dev/null
  elif command -v sudo >/dev/null; then
    sudo -n env DEBIAN_FRONTEND=noninteractive "$@" </dev/null
  else
    fail "packages are missing and neither root nor sudo is there to install them"
  fi
}

install_packages() {
  command -v dpkg-query >/dev/null || fail "this is no Debian system; install by hand: $PACKAGE_LIST"
  local missing
  mapfile -t missing < <(missing_packages)
  [[ ${#missing[@]} -eq 0 ]] && return
  say "installing ${#missing[@]} packages: ${missing[*]}"
  as_root apt-get -q -o Acquire::Retries=3 -o DPkg::Lock::Timeout=600 update
  as_root apt-get -q -y -o Acquire::Retries=3 -o DPkg::Lock::Timeout=600 \
    install --no-install-recommends "${missing[@]}"
}

# --- building ---------------------------------------------------------------------------------------

job_count() {
  local cores memory_kib jobs
  cores=$(nproc)
  memory_kib=$(awk '/^MemAvailable:/ { print $2 }' /proc/meminfo)
  jobs=$((memory_kib / MEMORY_PER_JOB_KIB))
  ((jobs > cores)) && jobs=$cores
  ((jobs < 1)) && jobs=1
  echo "$jobs"
}

# build_preset PRESET [TARGET...]
build_preset() {
  local preset=$1
  shift
  local folder=$ROOT/build/$preset
  if [[ ! -f $folder/build.ninja ]]; then
    say "configuring $preset"
    (cd "$ROOT" && cmake --preset "$preset" -DISOSLIDER_JOINED_BUILD=ON -DISOSLIDER_TEST_CASES=OFF)
  fi
  say "building $preset"
  cmake --build "$folder" --parallel "$(job_count)" ${1:+--target "$@"}
}

# --- run --------------------------------------------------------------------------------------------

has_display() { [[ -n ${DISPLAY:-} || -n ${WAYLAND_DISPLAY:-} ]]; }

run_window() {
  local program=$ROOT/build/release/bin/isoslider file=$1
  if has_display; then
    exec "$program" "$file"
  fi
  local picture=$ROOT/build/screenshot.png
  say "no display here: drawing the window into a picture"
  # Where nobody is logged in, Qt would remark on the missing folder.
  if [[ -z ${XDG_RUNTIME_DIR:-} ]]; then
    XDG_RUNTIME_DIR=$(mktemp -d)
    export XDG_RUNTIME_DIR
    trap 'rm -rf "$XDG_RUNTIME_DIR"' EXIT
  fi
  QT_QPA_PLATFORM=xcb xvfb-run -a -s "-screen 0 1920x1200x24" \
    "$program" "$file" --size "$WINDOW_SIZE" --screenshot "$picture" </dev/null
  say "the window is in $picture"
}

command_run() {
  [[ $# -le 1 ]] || { usage >&2; exit 2; }
  local file=${1:-$SAMPLE}
  [[ -e $file ]] || fail "$file: no such file"
  file=$(realpath -- "$file")
  install_packages
  build_preset release isoslider
  run_window "$file"
}

# --- test -------------------------------------------------------------------------------------------

declare -a SUMMARY=()
FAILURES=0
IS_AGAIN=false

# Everything a test run depends on: the files of the tree, and whether the further data is there.
tree_hash() {
  command -v git >/dev/null && git -C "$ROOT" rev-parse 2>/dev/null || return 1
  (cd "$ROOT" && git ls-files -co --exclude-standard -z | sort -z | xargs -0 sha1sum 2>/dev/null | sha1sum
    ls "$ROOT/../shared" 2>/dev/null | sha1sum) | sha1sum | cut -d' ' -f1
}

# run_ctest PRESET: ctest with its summary kept for the end. What has passed on these very files is not
# run again, unless --again asks for it. What fails beside other tests is tried once more alone, as times are
# measured in some; the summary names it.
run_ctest() {
  local preset=$1 log=$ROOT/build/ctest-$1.log stamp=$ROOT/build/tested-$1 status=0 hash
  hash=$(tree_hash) || hash=
  if [[ -n $hash && $IS_AGAIN == false && -f $stamp && $(<"$stamp") == "$hash" ]]; then
    say "$preset: these files have passed; --again runs the tests once more"
    SUMMARY+=("$preset (nothing has changed since):" "$(sed -n '/tests passed,/,$p' "$log")")
    return
  fi
  rm -f "$stamp"
  (cd "$ROOT" && ctest --preset "$preset" --parallel "$(nproc)") 2>&1 </dev/null | tee "$log" || status=$?
  if [[ $status -ne 0 ]]; then
    say "$preset: what failed is tried once more, alone"
    status=0
    (cd "$ROOT" && ctest --preset "$preset" --rerun-failed) 2>&1 </dev/null | tee -a "$log" || status=$?
  fi
  if [[ $status -eq 0 ]]; then
    [[ -z $hash ]] || echo "$hash" >"$stamp"
  else
    FAILURES=1
  fi
  SUMMARY+=("$preset:" "$(sed -n '/tests passed,/,$p' "$log")")
}

command_test() {
  local is_quick=false option
  for option in "$@"; do
    case $option in
      --quick) is_quick=true ;;
      --again) IS_AGAIN=true ;;
      *) usage >&2; exit 2 ;;
    esac
  done
  install_packages
  bash "$ROOT/packaging/ci/check.sh" --quick
  build_preset release
  bash "$ROOT/packaging/ci/check.sh" --links
  bash "$ROOT/packaging/ci/check.sh" --tidy
  run_ctest release
  if ! $is_quick; then
    build_preset asan-ubsan
    run_ctest asan-ubsan
  fi
  printf '\n%s\n' "${SUMMARY[@]}"
  return "$FAILURES"
}

case ${1:-} in
  run) shift; command_run "$@" ;;
  test) shift; command_test "$@" ;;
  -h | --help | help) usage ;;
  *) usage >&2; exit 2 ;;
esac
