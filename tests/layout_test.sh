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
while read -r stage; do
  others=$(sources stages | cut -d/ -f2 | sort -u | grep -vxE "$stage|contouring|solids" | paste -sd'|' || true)
  [ -z "$others" ] || forbid "stages/$stage" "stages/($others)/" "a stage includes another but contouring and solids, which they share"
done < <(sources stages | cut -d/ -f2 | sort -u)

# confine LIBRARY FOLDER: of the program, only FOLDER includes the library's headers.
confine() {
  local found
  found=$(sources 'storage|stages|pipeline' | grep -v "^$2/" |
    xargs -r grep -nHE "^[[:space:]]*#[[:space:]]*include[[:space:]]*[<\"]$1/" || true)
  [ -z "$found" ] || breach "$1 belongs to $2:
$found"
}
confine OpenImageIO storage/image
confine draco stages/encode
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
