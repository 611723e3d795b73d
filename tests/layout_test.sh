#!/usr/bin/env bash
# Holds the tree to its layout: what lies at the top level, who may include whom, which library is
# used where, and how long a file may be. Prints each breach and fails if there is any.
# Usage: tests/layout_test.sh [ROOT]
set -euo pipefail

root=${1:-$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)}
cd "$root"
max_lines=400
breaches=0

breach() {
  echo "$1"
  breaches=$((breaches + 1))
}

# Files of the tree: what git tracks or would; without git all but build folders.
files() {
  git ls-files --cached --others --exclude-standard 2>/dev/null ||
    find . -type f -not -path './build*' -not -path './.git/*' -printf '%P\n'
}
mapfile -t all < <(files | while read -r file; do [ ! -f "$file" ] || echo "$file"; done)
sources() { printf '%s\n' "${all[@]}" | grep -E "^($1)/.*\.(h|cpp)$" || true; }

# forbid FOLDERS INCLUDES RULE: no source below FOLDERS includes a path that INCLUDES matches.
forbid() {
  local found
  found=$(sources "$1" | xargs -r grep -nHE "^[[:space:]]*#[[:space:]]*include[[:space:]]*[<\"]($2)" || true)
  [ -z "$found" ] || breach "$3:
$found"
}

while read -r entry; do
  case $entry in
    CMakeLists.txt | README.md | LICENSE | pipeline | storage | stages | tests | configs | .*) ;;
    *) breach "not allowed at the top level: $entry" ;;
  esac
done < <(printf '%s\n' "${all[@]}" | cut -d/ -f1 | sort -u)

forbid storage 'stages/|pipeline/|tests/' 'storage stands below stages and pipeline'
forbid stages 'pipeline/|tests/' 'stages stand below pipeline'
forbid pipeline 'tests/' 'the program does not use its tests'
# Stages share contouring and solids, and whole puts them together; the rooms of the pipeline that
# control them share stage and solids, and run puts them together.
apart() {
  local layer=$1 rooms=$2 room
  for room in ${rooms//|/ }; do
    local others
    others=$(tr '|' '\n' <<<"$rooms" | grep -vx "$room" | paste -sd'|')
    forbid "$layer/$room" "$layer/($others)/" "a stage includes another stage"
  done
}
apart stages 'ingest|build|merge|stitch|refine|encode'
apart pipeline 'ingest|build|merge|stitch|refine|encode'

# No folder includes another that, by whatever way, includes it.
includes=$(mktemp)
trap 'rm -f "$includes"' EXIT
sources 'storage|stages|pipeline' | xargs -r grep -HoE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"[^"]+"' |
  sed -E 's|^([^:]*)/[^/:]*:[^"]*"([^"]*)/[^/"]*"$|\1 \2|' | awk '$1 != $2' | sort -u >"$includes"
[ -s "$includes" ] || breach "no includes found: this test looks at nothing"
if ! circle=$(tsort "$includes" 2>&1 >/dev/null); then
  breach "folders include each other in a circle:
$circle"
fi

# Types of one name in one namespace break a program quietly: of two inline members with the same
# symbol the linker keeps one. (Functions that are not inline it tells apart itself.)
twice=$(sources 'storage|stages|pipeline|tests' | xargs -r awk '
  FNR == 1 { space = ""; unnamed = 0 }
  /^namespace \{/ { unnamed = 1 }
  /^}  \/\/ namespace$/ { unnamed = 0 }
  /^namespace [a-z_:]+ \{/ { space = $2 }
  !unnamed && /^(class|struct|union|enum|enum class) [A-Z][A-Za-z0-9]*( |$)/ && !/;/ {
    name = space "::" $(/^enum class/ ? 3 : 2)
    if (name in where && where[name] != FILENAME) print name ": " where[name] ", " FILENAME
    where[name] = FILENAME
  }')
[ -z "$twice" ] || breach "one name, two types:
$twice"

# confine LIBRARY FOLDER: of the program, only FOLDER includes the library's headers.
confine() {
  local found
  found=$(sources 'storage|stages|pipeline' | grep -v "^$2/" |
    xargs -r grep -nHE "^[[:space:]]*#[[:space:]]*include[[:space:]]*[<\"]$1(/|\.h)" || true)
  [ -z "$found" ] || breach "$1 belongs to $2:
$found"
}
confine OpenImageIO storage/image
confine draco stages/encode
confine meshoptimizer stages/encode
confine OpenMesh pipeline/output

while read -r lines file; do
  [ "$lines" -le "$max_lines" ] || breach "longer than $max_lines lines: $file ($lines)"
done < <(sources 'storage|stages|pipeline|tests' | while read -r file; do
  echo "$(wc -l <"$file") $file"
done)

if [ "$breaches" -gt 0 ]; then
  echo "layout: $breaches breaches" >&2
  exit 1
fi
echo "layout: ${#all[@]} files in order"
