#!/usr/bin/env bash
# Redoes the table and the figures 1, 5, 7 and 12 of Ju, Losasso, Schaefer, Warren, "Dual Contouring
# of Hermite Data" (SIGGRAPH 2002) with stand-ins for its models, and compares surfaces of labels
# with surface nets. Leaves report.md and pictures. Fails where a mesh is not sound or a figure does
# not show what it is to show. Models that need a font (tests/paper/install_packages.sh) or a real
# scan that is not there are left out, and the report says so. Takes about three minutes.
# Usage: tests/paper/run.sh [OPTION...]
#   --out DIR     where to (default: BUILD/paper)
#   --build DIR   where the programs are (default: build)
#   --turns N     of each timed work, for the median (default: 7)
#   --small       models on small grids and no scans, in seconds: to see that all of it runs
# Environment: VOXWELD_SHARED_DATA (folder with bunny_ct/ and meshes/), VOXWELD_FONT.
set -euo pipefail

# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/../common.sh"
build=$root/build out='' turns=7 small=no
while [ $# -gt 0 ]; do
  case $1 in
    --out) out=$2 && shift ;;
    --build) build=$2 && shift ;;
    --turns) turns=$2 && shift ;;
    --small) small=yes turns=1 ;;
    -h | --help) exec bash "$0" --help ;;
    *) bash "$0" --help >&2 && exit 2 ;;
  esac
  shift
done
out=${out:-$build/paper}
data=${VOXWELD_SHARED_DATA:-$root/../shared/data}
font=${VOXWELD_FONT:-/usr/share/fonts/truetype/wqy/wqy-microhei.ttc}
for program in voxweld paper_models paper_table paper_figure paper_cuts paper_labels; do
  require_program "$build/$program" "build the tests, or name their folder with --build"
done
part=64 temple=256 cube=128 cuts=60 pixels=(--width 1200 --height 900) tolerances=(0.01 0.5 1 2 4)
[ "$small" = no ] || part=32 temple=64 cube=64 cuts=3 pixels=(--width 160 --height 120) tolerances=(4)
models=$out/models report=$out/report.md failures=0
mkdir -p "$models"
rm -f "$out"/*.png
: >"$out/rows"
log=$out/log
: >"$log"

say() { printf '%s\n' "$*" >>"$report"; }
fail() {
  echo "FAILED: $*" >&2
  say "FAILED: $*"
  failures=$((failures + 1))
}
scaled() { awk -v c="$temple" 'BEGIN { for (i = 1; i < ARGC; ++i) printf "%s ", ARGV[i] * c / 256; print "" }' "$@"; }

# row CONFIG NAME GRID QUADS MS MB: a line of both tables; the program itself makes and verifies the
# same, and draws it.
row() {
  local config=$models/$1.toml
  "$build/paper_table" "$config" --name "$2" --grid "$3" --paper "$4" "$5" "$6" --turns "$turns" \
    --set work.brick=32 >>"$out/rows"
  if ! { "$build/voxweld" run "$config" && "$build/voxweld" verify "$models/$1.mesh"; } >>"$log" 2>&1; then
    fail "$2: what voxweld run leaves is not sound: $log"
    return 0
  fi
  [ "$small" = no ] || return 0
  "$build/voxweld" render "$models/$1.mesh" -o "$out/model_$1.png" --force "${pixels[@]}" >>"$log"
}
skip() { printf '%s: left out: %s\n' "$1" "$2" | tee -a "$out/skipped"; }

# settings CONFIG: the config of standard input, with what is the same for all models.
settings() {
  cat - >"$models/$1.toml" <(printf '%s\n' '[simplify]' 'tolerance = 0.01' 'metric = "sum"' 'refine = "off"' \
    '[output]' 'formats = ["drc"]' '[run]' 'threads = 1')
}

phantom() { # KIND CELLS: a sampled one, and its config
  "$build/voxweld" phantom "$1" --size $(($2 - 1)) -o "$models/phantom_$1.nrrd" --force >>"$log"
  printf '[input]\npath = "phantom_%s.nrrd"\n[surface]\nisovalue = 32767.5\ninside = "below"\n' "$1" |
    settings "phantom_$1"
}

bunny() { # unpacks it and writes its config
  [ -f "$models/bunny.raw" ] || xz -dc "$data/bunny_ct/bunny_512x512x361_i16be.raw.xz" >"$models/bunny.raw"
  bunny_config bunny.raw | settings bunny
}

labels_of_cube() { # writes their config
  printf '[input]\npath = "cube.nrrd"\n[labels]\nmode = "shared"\n' | settings cube_labels
}

make_models() {
  rm -f "$out/skipped"
  "$build/paper_models" "$models" --part $part --temple $temple
  phantom part $part
  phantom temple $temple
  if [ ! -r "$font" ]; then
    skip "cube of characters" "needs $font"
  else
    "$build/paper_models" "$models" --part $part --temple $temple --cube $cube --font "$font" ||
      skip "cube of characters" "see the message above"
  fi
  [ "$small" = no ] || return 0
  if [ ! -r "$data/meshes/rocker-arm.obj" ]; then
    skip "fandisk and rocker arm" "needs $data/meshes"
  else
    "$build/paper_models" "$models" --mesh fandisk "$data/meshes/fandisk.obj" 64 \
      --mesh rocker_arm "$data/meshes/rocker-arm.obj" 512
  fi
  if [ ! -r "$data/bunny_ct/bunny_512x512x361_i16be.raw.xz" ] || ! command -v xz >/dev/null; then
    skip "bunny" "needs $data/bunny_ct and xz"
  else
    bunny
  fi
}

rows_of_table() {
  row part "part: exact solids" $part^3 2578 44 1.3
  row phantom_part "part: sampled" $part^3 2578 44 1.3
  [ ! -f "$models/fandisk.toml" ] || row fandisk "part: fandisk, a mesh" 64^3 2578 44 1.3
  if [ -f "$models/cube.toml" ]; then
    labels_of_cube
    row cube "cube of characters: exact, one material" $cube^3 1646 636 32
    row cube_materials "cube of characters: exact, three materials" $cube^3 1646 636 32
    row cube_labels "cube of characters: labels of voxels" $cube^3 1646 636 32
  fi
  row temple "temple: exact solids" $temple^3 39201 3586 156
  row temple_turned "temple: exact, turned off the grid" $temple^3 39201 3586 156
  row phantom_temple "temple: sampled, round columns" $temple^3 39201 3586 156
  [ ! -f "$models/rocker_arm.toml" ] || row rocker_arm "statue: rocker arm, a mesh" 512^3 143533 2948 91
  [ ! -f "$models/bunny.toml" ] || row bunny "statue: bunny, a CT scan" "512^2 x 361" 143533 2948 91
}

table() {
  say "## Table: error 0.01 in the sum of squares, topology kept"
  say
  say "Milliseconds are the processor's, one thread, median of $turns. From Hermite data: the signed octree"
  say "with its crossings and normals is in memory, as in the paper; from samples: all of it. Bricks of"
  say "32 cells."
  say
  say "| model | grid | polygons, paper | ours | ms, paper | ours, from Hermite data | ratio | under 1/10 | µs a polygon, paper | ours | ms from samples |"
  say "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
  sed -n 's/^time: //p' "$out/rows" >>"$report"
  say
  say "The octree of the whole volume at once is signs, Hermite data and all nodes with their QEFs, as the"
  say "paper keeps it. The peak is what build holds at most beyond the samples, brick by brick, with the"
  say "simplified octrees and polygons it leaves."
  say
  say "| model | grid | MB, paper | octree at once | ratio | under 1/10 | peak, brick by brick | ratio | under 1/10 | what is left |"
  say "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
  sed -n 's/^space: //p' "$out/rows" >>"$report"
  say
  [ ! -f "$out/skipped" ] || { cat "$out/skipped" >>"$report" && say; }
}

# What `voxweld edit` takes for one ball after the other: wall and processor time, medians.
edit_commands() {
  local name=$1 title=$2 config=$models/cut_$1.toml place
  local options=(--set work.brick=32 --set work.shard=2 --set output.tile_vertices=8192 --set output.merged=false)
  cp "$models/$name.toml" "$config"
  rm -rf "$models/cut_$name".{work,mesh}
  "$build/voxweld" run "$config" "${options[@]}" >>"$log" 2>&1
  : >"$out/times"
  local TIMEFORMAT='%R %U %S'
  head -"$((cuts < 12 ? cuts : 12))" "$out/places_$name" | while read -r place; do
    { time "$build/voxweld" edit "$config" --add sphere --op subtract --center "$place" --radius 6 \
      "${options[@]}" >>"$log" 2>&1; } 2>>"$out/times"
  done
  "$build/voxweld" verify "$models/cut_$name.mesh" >>"$log" || fail "$title: not sound after its cuts"
  sort -n "$out/times" | awk -v title="$title" '{ wall[NR] = $1; cpu[NR] = $2 + $3; sum += cpu[NR] }
    END { m = int((NR + 1) / 2)
          printf "| %s | %d | %.0f | %.0f | %.0f |\n", title, NR, 1e3 * wall[m], 1e3 * wall[NR], 1e3 * sum / NR }' >>"$report"
}

figure_1() {
  local name
  say "## Figure 1: balls of radius 6 taken out of the temple; the paper: about 30 ms each"
  say
  say "In one process, Hermite data kept as the paper keeps it, bricks of 32 cells; ms of the processor."
  say
  say "| model | cuts | ms a cut, median | most | CSG | simplify | stitch | bricks | tiles |"
  say "| --- | --- | --- | --- | --- | --- | --- | --- | --- |"
  for name in temple phantom_temple; do
    "$build/paper_cuts" "$models/$name.toml" --name "$name" --cuts $cuts --set work.brick=32 \
      --set work.shard=4 --set output.tile_vertices=4096 --places "$out/places_$name" "${pixels[@]}" \
      --before "$out/figure_1_${name}_before.png" --after "$out/figure_1_${name}_after.png" >>"$report"
  done
  say
  say "The whole command \`voxweld edit --add sphere\`, start, reading and writing files included;"
  say "shards of 2 bricks of 32 cells, tiles of 8192 vertices. It builds what it reaches from all edits anew."
  say
  say "| model | cuts | ms a cut, wall, median | most | ms of the processor, mean |"
  say "| --- | --- | --- | --- | --- |"
  edit_commands temple temple
  edit_commands phantom_temple phantom_temple
  say
}

counted() { # FIGURE KEY
  echo "$1" | sed -n "s/.*\b$2 \([0-9-]*\).*/\1/p"
}

figure_7() {
  local name qr normal centre view
  read -ra centre < <(scaled 200 70 170)
  view=("${pixels[@]}" --edges 0.08 --azimuth 30 --elevation 15 --zoom 3.2 --centre "${centre[@]}")
  say "## Figure 7: polygons at error 0.014, by what QEFs are kept as; the paper: 78K and 36K"
  say
  say "| model | normal equations | QR | ratio |"
  say "| --- | --- | --- | --- |"
  for name in temple temple_turned temple_round phantom_temple; do
    local common=("$models/$name.toml" --set simplify.tolerance=0.014)
    normal=$(counted "$("$build/paper_figure" "${common[@]}" --set simplify.qef=normal "${view[@]}" \
      -o "$out/figure_7_${name}_normal.png")" polygons)
    qr=$(counted "$("$build/paper_figure" "${common[@]}" --set simplify.qef=qr "${view[@]}" \
      -o "$out/figure_7_${name}_qr.png")" polygons)
    say "| $name | $normal | $qr | $(awk -v a="$normal" -v b="$qr" 'BEGIN { printf "%.2f", a / b }') |"
    [[ $name == *_round || $name == phantom_* ]] || [ "${normal:-0}" -gt "${qr:-0}" ] ||
      fail "figure 7, $name: the normal equations give no more polygons than QR"
  done
  say
  say "Where the columns are round most cells do not collapse at such an error whatever the QEFs are kept"
  say "as: the exact temple with round columns (temple_round) is like the sampled one (phantom_temple)."
  say
}

figure_12() {
  local full full_materials manifold safe free materials tolerance view name
  [ -f "$models/cube.toml" ] || return 0
  "$build/paper_figure" "$models/cube_materials.toml" -o "$out/figure_5.png" --azimuth -25 --elevation 30 \
    --edges 0.06 "${pixels[@]}" >/dev/null
  full=$("$build/paper_figure" "$models/characters.toml" --set simplify.enabled=false --parts)
  # Parts of one material that come within a cell of each other share a vertex of the complex.
  full_materials=$("$build/paper_figure" "$models/cube_materials.toml" --set simplify.enabled=false --parts)
  say "## Figure 12: components of the cube's characters; not simplified: $(counted "$full" components), of three materials $(counted "$full_materials" components)"
  say
  say "| error | manifold: polygons | components | defects | safe: polygons | components | defects | free: polygons | components | defects | three materials: polygons | components |"
  say "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
  for tolerance in "${tolerances[@]}"; do
    local error=(--set "simplify.tolerance=$tolerance")
    manifold=$("$build/paper_figure" "$models/characters.toml" "${error[@]}" --parts)
    safe=$("$build/paper_figure" "$models/characters.toml" --set simplify.topology=safe "${error[@]}" --parts)
    free=$("$build/paper_figure" "$models/characters.toml" --set simplify.topology=free "${error[@]}" --parts)
    materials=$("$build/paper_figure" "$models/cube_materials.toml" "${error[@]}" --parts)
    say "| $tolerance | $(counted "$manifold" polygons) | $(counted "$manifold" components) | $(counted "$manifold" defects)" \
      "| $(counted "$safe" polygons) | $(counted "$safe" components) | $(counted "$safe" defects)" \
      "| $(counted "$free" polygons) | $(counted "$free" components) | $(counted "$free" defects)" \
      "| $(counted "$materials" polygons) | $(counted "$materials" components) |"
    for name in manifold safe; do
      [ "$(counted "${!name}" components) $(counted "${!name}" defects)" = "$(counted "$full" components) 0" ] ||
        fail "figure 12: topology = \"$name\" at $tolerance does not keep the characters' parts apart"
    done
    [ "$(counted "$materials" components)" = "$(counted "$full_materials" components)" ] ||
      fail "figure 12: of three materials the characters' parts do not stay apart at $tolerance"
  done
  [ "$(counted "$free" components)0" -lt "$(counted "$full" components)0" ] ||
    fail "figure 12: topology = \"free\" at 4 fuses nothing"
  say
  view=(--set simplify.tolerance=4 "${pixels[@]}" --azimuth 10 --elevation 12 --zoom 1.5 --edges 0.1)
  for name in manifold safe free; do
    "$build/paper_figure" "$models/characters.toml" --set simplify.topology=$name "${view[@]}" \
      -o "$out/figure_12_$name.png" >/dev/null
  done
}

labels() {
  say "## Surfaces of labels, of solids made voxels"
  say
  "$build/paper_labels" >>"$report" || fail "labels: a surface net is nearer to a solid than voxweld's surface"
  say
}

printf '# Dual Contouring of Hermite Data, redone\n\n' >"$report"
say "On $(uname -m), $(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -1), $(nproc) processors of which others may use some: load $(cut -d' ' -f1 /proc/loadavg)."
say
make_models
rows_of_table
table
figure_1
figure_7
figure_12
labels
cat "$report"
[ "$failures" -eq 0 ] || exit 1
