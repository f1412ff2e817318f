#!/usr/bin/env bash
# Rules that no compiler sees: which way the arrows point, how long files are, that every test runs.
# Stops at the first rule that is broken.
#
#   packaging/ci/check.sh           everything
#   packaging/ci/check.sh --quick   what reads sources only
#   packaging/ci/check.sh --links   the link graph, which needs a configured build
#   packaging/ci/check.sh --tidy    clang-tidy over what changed last, which needs build/release
set -euo pipefail

ROOT=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
readonly ROOT
cd "$ROOT"

readonly MAX_SOURCE_LINES=600 MAX_HEADER_LINES=150

fail() {
  printf 'check.sh: %s\n' "$1" >&2
  [[ -z ${2:-} ]] || printf '%s\n' "$2" >&2
  exit 1
}
warn() { printf 'check.sh: warning: %s\n' "$*" >&2; }

# Files of the project, also those not yet committed; without git, all below the source folders.
project_files() {
  if git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
    git ls-files --cached --others --exclude-standard -- "$@"
  else
    find core preprocess ui app tests packaging resources -type f
  fi
}

sources_below() { project_files "$@" | grep -E '\.(h|hpp|cpp|cc)$' || true; }

# --- includes ---------------------------------------------------------------------------------------

# refuse_includes WHAT PATTERN FOLDER...
refuse_includes() {
  local what=$1 pattern=$2 hits
  shift 2
  hits=$(sources_below "$@" | grep -E "^($(IFS='|'; echo "$*"))/" | xargs -r -d '\n' grep -nE "$pattern" || true)
  [[ -z $hits ]] || fail "$what is included where it must not be" "$hits"
}

check_includes() {
  local qt='#include *[<"](Q[A-Z][A-Za-z]*|Qt[A-Z][A-Za-z]*/|qcustomplot)'
  local gl='#include *[<"](GL/|GLES|EGL/|epoxy/|glad/)'
  refuse_includes "Qt" "$qt" core preprocess ui/model app/cli
  refuse_includes "OpenGL" "$gl" core preprocess ui/model app/cli
  refuse_includes "preprocess" '#include *"preprocess/' core ui
  refuse_includes "ui" '#include *"ui/' core preprocess app/cli
  refuse_includes "ui/render or ui/widgets" '#include *"ui/(render|widgets)/' ui/model
  refuse_includes "ui/widgets" '#include *"ui/widgets/' ui/render
  refuse_includes "app" '#include *"app/' core preprocess ui
  refuse_includes "A widget" '#include *[<"]Q(Widget|Application|MainWindow|Dialog)[>"]' ui/render
}

# allow_includes ROOM ALLOWED...: files below ROOM include of core only what is below ROOM and ALLOWED.
allow_includes() {
  local room=$1 allowed hits
  allowed=$(IFS='|'; echo "$*")
  hits=$(sources_below core | grep -E "^$room/" | xargs -r -d '\n' grep -nE '#include *"core/' |
    grep -vE "#include *\"($allowed)/" || true)
  [[ -z $hits ]] || fail "below $room only $* may be included" "$hits"
}

# The arrows between the rooms of core.
check_rooms() {
  allow_includes core/base
  allow_includes core/grid core/base
  allow_includes core/cell core/base core/grid
  allow_includes core/index/format core/base core/grid
  allow_includes core/index core/base core/grid
  allow_includes core/extract core/base core/grid core/cell core/index
  allow_includes core/topology core/base core/grid core/cell core/index
  allow_includes core/mesh core/base core/grid core/extract
  allow_includes core/volume_io core/base core/grid
}

# The disk is reached through core/base alone, where tests can stand in for it and errors have one wording. Not the
# system's own files below /proc, which are no user's.
check_disk() {
  local hits
  hits=$(sources_below core preprocess ui app | grep -v '^core/base/' | xargs -r -d '\n' grep -nE \
    '\b(fs|filesystem)::(exists|is_[a-z]+|status|symlink_status|file_size|remove|remove_all|rename|copy|create_[a-z]+|last_write_time|(recursive_)?directory_iterator|(weakly_)?canonical|equivalent|read_symlink|resize_file|space|temp_directory_path)\b' || true)
  [[ -z $hits ]] || fail "the disk is reached past core/base (folders.h, file_system.h)" "$hits"
}

# --- format -----------------------------------------------------------------------------------------

check_format() {
  local hits
  command -v clang-format-14 >/dev/null || { warn "no clang-format-14: the format is not checked"; return; }
  hits=$(sources_below | xargs -r -d '\n' clang-format-14 --dry-run 2>&1 | grep 'clang-format-violations' | cut -d: -f1 | sort -u || true)
  [[ -z $hits ]] || fail "clang-format-14 -i would change" "$hits"
}

# --- clang-tidy -------------------------------------------------------------------------------------

# Of what the last commits changed, the newest first: some seconds each, so no more than a few minutes' worth.
readonly TIDY_COMMITS=12 MAX_TIDY_FILES=16

check_tidy() {
  local files database=build/tidy/compile_commands.json
  [[ -f build/release/compile_commands.json ]] || fail "clang-tidy needs the build in build/release"
  command -v clang-tidy-14 >/dev/null || { warn "no clang-tidy-14"; return; }
  files=$({ git diff --name-only HEAD; git log -n "$TIDY_COMMITS" --name-only --format=; } 2>/dev/null |
    grep -E '^(core|preprocess|ui|app)/.*\.cpp$' | awk '!seen[$0]++' |
    while read -r file; do [[ ! -f $file ]] || echo "$file"; done | head -n "$MAX_TIDY_FILES" || true)
  [[ -n $files ]] || return 0
  # A build of joined files does not say how each is compiled.
  cmake --preset release -B build/tidy -DISOSLIDER_JOINED_BUILD=OFF -DISOSLIDER_TEST_CASES=OFF >/dev/null ||
    fail "build/tidy cannot be configured"
  # Clang cannot use the headers that GCC has compiled; their files do not rely on them.
  sed -i -E 's/-Winvalid-pch//g; s/-include [^ ]*cmake_pch\.hxx//g' "$database"
  xargs -d '\n' -n1 -P"$(nproc)" clang-tidy-14 -p build/tidy --quiet <<<"$files" 2>/dev/null ||
    fail "clang-tidy objects (.clang-tidy names what is checked)"
}

# --- sizes ------------------------------------------------------------------------------------------

# Tables are data and tests are lists; both may be as long as they are.
check_sizes() {
  local lines file
  while read -r lines file; do
    [[ $file == total ]] && continue
    case $file in
      tests/*) continue ;;
      *table*.cpp | *table*.h) continue ;;
    esac
    ((lines <= MAX_SOURCE_LINES)) || fail "$file has $lines lines, more than $MAX_SOURCE_LINES"
    if [[ $file == *.h ]] && ((lines > MAX_HEADER_LINES)); then
      warn "$file has $lines lines; public headers aim for at most $MAX_HEADER_LINES"
    fi
  done < <(sources_below | xargs -r -d '\n' wc -l)
}

# --- tests ------------------------------------------------------------------------------------------

# A test that no CMakeLists.txt names is a test that nobody runs.
check_registration() {
  local file folder name
  while read -r file; do
    name=${file##*/}
    folder=${file%/*}
    while [[ $folder == tests* ]]; do
      if [[ -f $folder/CMakeLists.txt ]] &&
        grep -qE "(^|[[:space:]/])(${file#"$folder"/}|$name)([[:space:])]|\$)" "$folder/CMakeLists.txt"; then
        continue 2
      fi
      [[ $folder == */* ]] || break
      folder=${folder%/*}
    done
    fail "$file is in no CMakeLists.txt"
  done < <(project_files tests | grep -E '^tests/.*_test\.cpp$' || true)
}

# Nothing that was built is kept: no compiled program, and no file larger than the largest sample and picture.
readonly MAX_FILE_BYTES=1000000

check_binaries() {
  local built large
  built=$(project_files | xargs -r -d '\n' grep -laP '\A(\x7fELF|!<arch>)' 2>/dev/null || true)
  [[ -z $built ]] || fail "compiled files are not kept" "$built"
  large=$(project_files | while read -r file; do
    [[ ! -f $file ]] || (($(stat -c %s "$file") <= MAX_FILE_BYTES)) || echo "$file"
  done)
  [[ -z $large ]] || fail "files of more than $MAX_FILE_BYTES bytes are not kept" "$large"
}

check_documents() {
  local file
  for file in LICENSE README.md CHANGELOG.md CONTRIBUTING.md; do
    [[ -s $file ]] || fail "$file is missing"
  done
  grep -q 'GNU GENERAL PUBLIC LICENSE' LICENSE || fail "LICENSE is not the GPL"
}

# --- the link graph -----------------------------------------------------------------------------------

# Labels instead of dot's node numbers: "from to" a line, for what each target links.
link_edges() {
  awk '
    /label = "/ && /"node[0-9]+" \[/ {
      node = $1; gsub(/"/, "", node)
      label = $0; sub(/.*label = "/, "", label); sub(/[\\"].*/, "", label)
      name[node] = label
    }
    /"node[0-9]+" -> "node[0-9]+"/ {
      from = $1; to = $3; gsub(/[";]/, "", from); gsub(/[";]/, "", to)
      edges[++count] = from " " to
    }
    END { for (i = 1; i <= count; ++i) { split(edges[i], e, " "); print name[e[1]], name[e[2]] } }
  ' "$1"
}

# reaches EDGES TARGET PATTERN: a target matching the pattern that TARGET links, directly or not
reaches() {
  awk -v start="$2" -v pattern="$3" '
    { next_of[$1] = next_of[$1] " " $2 }
    END {
      queue[last = 1] = start; seen[start] = 1
      for (first = 1; first <= last; ++first) {
        count = split(next_of[queue[first]], next_ones, " ")
        for (i = 1; i <= count; ++i)
          if (!(next_ones[i] in seen)) { seen[next_ones[i]] = 1; queue[++last] = next_ones[i] }
      }
      for (i = 2; i <= last; ++i) if (queue[i] ~ pattern) print queue[i]
    }' "$1"
}

check_links() {
  local build=$ROOT/build/release scratch rule target pattern found
  [[ -f $build/CMakeCache.txt ]] || { warn "no build in build/release: the link graph is not checked"; return; }
  scratch=$(mktemp -d)
  trap 'rm -rf -- "$scratch"' RETURN
  cmake --graphviz="$scratch/links.dot" "$build" >"$scratch/log" 2>&1 || fail "cmake --graphviz failed" "$(cat "$scratch/log")"
  link_edges "$scratch/links.dot" >"$scratch/edges"
  grep -q '^isoslider_core ' "$scratch/edges" || fail "the link graph names no isoslider_core"
  for rule in \
    'isoslider_core ^(Qt|QCustomPlot|isoslider_(preprocess|ui_|volume_|mesh))|OpenGL::' \
    'isoslider_volume_io ^(VTK::|gdcm|TIFF::|PkgConfig::(HDF5|NETCDF))|^isoslider_library_formats' \
    'isoslider_volume_io ^(Qt|QCustomPlot|isoslider_(preprocess|ui_))' \
    'isoslider_mesh ^(Qt|QCustomPlot|isoslider_(preprocess|ui_))' \
    'isoslider_preprocess ^(Qt|QCustomPlot|isoslider_ui_)' \
    'isoslider_ui_model ^(Qt|QCustomPlot|OpenGL::|isoslider_(preprocess|ui_render|ui_widgets))' \
    'isoslider_ui_render ^(Qt[0-9]*::(Widgets|OpenGLWidgets)|isoslider_(preprocess|ui_widgets))' \
    'isoslider_ui_widgets ^isoslider_preprocess' \
    'isoslider-cli ^(Qt|QCustomPlot|isoslider_ui_)'; do
    target=${rule%% *}
    pattern=${rule#* }
    found=$(reaches "$scratch/edges" "$target" "$pattern")
    [[ -z $found ]] || fail "$target links what it must not" "$found"
  done
  # What takes long to load is loaded by the reader's process only.
  for target in isoslider isoslider-cli; do
    [[ -x $build/bin/$target ]] || continue
    found=$(ldd "$build/bin/$target" | grep -E 'lib(vtk|gdcm|netcdf|hdf5)' || true)
    [[ -z $found ]] || fail "$target loads libraries that only isoslider-reader needs" "$found"
  done
  # Each program alone is built with the reader's process, without which it cannot read every format.
  for target in isoslider isoslider-cli; do
    ninja -C "$build" -t inputs "$target" | grep 'bin/isoslider-reader$' >/dev/null || fail "$target is built without isoslider-reader"
  done
}

case ${1:-} in
  '' | --quick | --links | --tidy) ;;
  *) printf 'usage: %s [--quick | --links | --tidy]\n' "${0##*/}" >&2; exit 2 ;;
esac
if [[ ${1:-} == --tidy ]]; then
  check_tidy
  echo "check.sh: clang-tidy has no objection"
  exit
fi
if [[ ${1:-} != --links ]]; then
  check_includes
  check_rooms
  check_disk
  check_format
  check_sizes
  check_registration
  check_documents
  check_binaries
fi
[[ ${1:-} == --quick ]] || check_links
echo "check.sh: all rules kept"
