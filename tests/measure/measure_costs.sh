#!/usr/bin/env bash
# What each unit of each stage costs, measured: makes a phantom, runs every unit as a command of its
# own, as a task of a cluster would (work.copy = true), with one thread, and writes the figures as
# JSON for cluster_simulation. Some units run once more before, under strace, for their round trips
# to a file system: calls that name a path of the work, output or input, flushes, and the first read
# of each opened file. Without strace there are none. Takes about a minute at -s 1024.
# Usage: tests/measure/measure_costs.sh [OPTION...] -o COSTS [VOXWELD]   (default: build/voxweld)
#   -k gyroid -s 1024 -t uint8   the phantom: kind, samples a side, type
#   -b 64 -n 4                   work.brick and work.shard
#   -e 8                         every 8th unit is traced
#   -x                           only tasks with nothing to do, for how they grow with the shards
set -euo pipefail

usage() {
  sed -n '2,12s/^# //p' "$0"
  exit "$1"
}

kind=gyroid size=1024 type=uint8 every=8 brick=64 shard=4 only_empty=no costs=
while getopts k:s:t:e:b:n:o:xh option; do
  case $option in
    k) kind=$OPTARG ;; s) size=$OPTARG ;; t) type=$OPTARG ;; e) every=$OPTARG ;;
    b) brick=$OPTARG ;; n) shard=$OPTARG ;; o) costs=$OPTARG ;; x) only_empty=yes ;;
    h) usage 0 ;;
    *) usage 2 >&2 ;;
  esac
done
shift $((OPTIND - 1))
[ -n "$costs" ] || usage 2 >&2
voxweld=$(realpath "${1:-$(dirname "$0")/../../build/voxweld}")
traced=$(command -v strace || true)

folder=$(mktemp -d "${TMPDIR:-/tmp}/vxwcosts.XXXX")
trap 'rm -rf "$folder"' EXIT
config=$folder/c.toml lines=$folder/lines
mkdir "$folder/c.work" "$folder/c.mesh"
: >"$lines"
"$voxweld" phantom "$kind" --size "$size" --type "$type" -o "$folder/v.nrrd" --log-level quiet >&2
read -r isovalue inside < <(head -c 400 "$folder/v.nrrd" |
  sed -n 's/^# isovalue \([0-9.]*\), inside \([a-z]*\).*/\1 \2/p')
cat >"$config" <<END
[input]
path = "v.nrrd"
[surface]
isovalue = $isovalue
inside = "$inside"
[work]
copy = true
brick = $brick
shard = $shard
chunk = $((brick * shard < 32 ? brick * shard : 32))
[simplify]
refine = "off"
[run]
threads = 1
END

# timed COMMAND...: sets wall and cpu (seconds), read_bytes, written_bytes.
timed() {
  local figures
  # shellcheck disable=SC2016 # variables of the inner shell, whose counters its child's add to
  figures=$(bash -c '
    TIMEFORMAT="%3R %3U %3S"
    time "$@" >/dev/null 2>&1 || exit
    sed -n "s/^[rw]char: //p" "/proc/$$/io"' timed "$@" 2>&1)
  read -r wall user system read_bytes written_bytes <<<"${figures//$'\n'/ }"
  cpu=$(awk "BEGIN { print $user + $system }")
}

# Round trips of COMMAND to a file system: trips COMMAND... prints how many.
trips() {
  local calls=openat,newfstatat,statx,access,mkdir,rename,unlink,unlinkat,getdents64,fsync
  strace -f -y -qq -o "$folder/trace" -e "trace=$calls,pread64,read" "$@" >/dev/null 2>&1
  grep -F "$folder/" "$folder/trace" | grep -vF "$folder/trace" | awk '
    /newfstatat\([0-9]+<[^>]*>, "",/ { next }              # of what is open: known since then
    / (pread64|read)\(/ { if (match($0, /\([0-9]+<[^>]*/)) {
      file = substr($0, RSTART, RLENGTH); if (!(file in seen)) { seen[file] = 1; ++n } } next }
    / openat\(/ { if (match($0, /= [0-9]+<[^>]*/))
      delete seen["(" substr($0, RSTART + 2, RLENGTH - 2)] }
    { ++n }
    END { print n + 0 }'
}

# Files made since the marker, without what is common to all units.
made() { find "$folder/c.work" "$folder/c.mesh" -type f -newer "$folder/marker"; }
peak_of() { jq .peak_resident_bytes "$folder/report" 2>/dev/null || echo 0; }

# measure STAGE OPTION UNIT
measure() {
  local stage=$1 count=- files
  local command=("$voxweld" "$stage" "$config" "$2" "$3" --log-level quiet
    --report "$folder/report" --inputs-checked)
  touch -d '1 second ago' "$folder/marker"
  if [ -n "$traced" ] && [ $(($3 % every)) -eq 0 ]; then
    sleep 1.1 # so that no file of the unit before is taken for this one's
    touch "$folder/marker"
    count=$(trips "${command[@]}")
    made | xargs -r rm -f
  fi
  touch "$folder/marker"
  timed "${command[@]}"
  files=$(made | wc -l)
  printf '%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\n' "$stage" "$3" "$wall" "$cpu" "$(peak_of)" \
    "$read_bytes" "$written_bytes" "$files" "$count" >>"$lines"
}

# A task of no unit, the share of a cut so fine that it is empty: the cheapest of seven.
empty() {
  local stage=$1 count=-
  local command=("$voxweld" "$stage" "$config" --part 99999999/100000000 --log-level quiet
    --report "$folder/report")
  if [ -n "$traced" ]; then count=$(trips "${command[@]}"); fi
  for _ in 1 2 3 4 5 6 7; do
    timed "${command[@]}"
    printf '%s\t%s\t%s\t%s\t%s\t%s\t%s\t0\t%s\n' empty "$stage" "$wall" "$cpu" "$(peak_of)" \
      "$read_bytes" "$written_bytes" "$count"
  done | sort -t $'\t' -k4,4g | sed 1q >>"$lines"
}

side=$(((size + brick * shard - 1) / (brick * shard)))
shards=$((side * side * side))
stage_units() { # stage_units STAGE OPTION COUNT: each unit, then what closes the stage
  local k
  if [ "$only_empty" = no ]; then
    for ((k = 0; k < $3; k++)); do measure "$1" "$2" "$k"; done
  fi
  if [ "$1" != encode ]; then "$voxweld" "$1" "$config" --log-level quiet; fi
  empty "$1"
  echo "$1: $3 units" >&2
}
stage_units ingest --shards "$shards"
stage_units build --shards "$shards"
timed "$voxweld" merge "$config" --inputs-checked --log-level quiet
printf 'merge\t0\t%s\t%s\t0\t%s\t%s\t1\t-\n' "$wall" "$cpu" "$read_bytes" "$written_bytes" \
  >>"$lines"
top=$(find "$folder/c.work" -name top.tree)
"$voxweld" info "$top" --json --verbose >"$folder/top.json"
tiles=$(jq .tiles "$folder/top.json")
stage_units stitch --tiles "$tiles"
stage_units encode --tiles "$tiles"

jq -R -s --slurpfile top "$folder/top.json" --arg kind "$kind" --argjson size "$size" \
  --argjson shards "$shards" --argjson side "$((brick * shard))" '
  def number: if . == "-" then null else tonumber end;
  def costs: [["wall_s", "cpu_s", "peak_bytes", "read_bytes", "written_bytes", "files", "trips"],
    (.[2:] | map(number))] | transpose | map({key: .[0], value: .[1]}) | from_entries;
  def weight($stage; $unit): $top[0].tile_list[$unit] as $tile |
    if $stage == "stitch" then $tile.vertices + $tile.polygons
    elif $stage == "encode" then $tile.polygons else null end;
  [split("\n")[] | select(. != "") | split("\t")] as $rows |
  { phantom: $kind, size: $size, shards: $shards, shard_samples: $side, tiles: $top[0].tiles,
    vertices: $top[0].vertices,
    empty_task: ([$rows[] | select(.[0] == "empty") | {key: .[1], value: costs}] | from_entries),
    stages: ($rows | map(select(.[0] != "empty")) | group_by(.[0]) | map({key: .[0][0],
      value: map(. as $row | (.[1] | tonumber) as $unit |
        costs + {unit: $unit, weight: weight($row[0]; $unit)})}) | from_entries) }' "$lines" \
  >"$folder/costs.json"
mv "$folder/costs.json" "$costs"
