#!/usr/bin/env bash
# Has libFuzzer look for inputs that break a parser (fuzz/README.md), each entry for a while. What is
# found stays in a folder. Prints a table; exit code 1 with finds.
# Usage: tests/coverage_fuzz.sh [--seconds T] [--jobs N] [--seed N] [--modules] [--finds FOLDER]
#        [ENTRY...]
#   --seconds   for each entry, 60
#   --jobs      entries at once, as many as there are processors
#   --seed      of the choices it makes, 0: another one each time (0)
#   --modules   also the entries that are in modules (tiff, hdf5, dicom, image)
#   --finds     build-fuzz/finds
# With the usual build (BUILD_DIR, else build) there are more seeds.
# Needs clang with its runtime libraries; exit code 77 without. The build is build-fuzz; what was learned of each parser
# stays in build-fuzz/corpus, so that later turns go on from there.
set -euo pipefail
# shellcheck source=tests/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

build=$root/build-fuzz
# Of the usual build: finished runs are seeds too.
program=("${BUILD_DIR:-$root/build}/voxweld")
[ -x "${program[0]}" ] || program=()
seconds=60 seed=0 jobs=$(nproc) modules=() finds=$build/finds
entries=()
in_modules=(tiff hdf5 dicom image) # so are their entries called
while [ $# -gt 0 ]; do
  case $1 in
    --seconds) seconds=$2 && shift ;;
    --seed) seed=$2 && shift ;;
    --jobs) jobs=$2 && shift ;;
    --finds) finds=$2 && shift ;;
    --modules) modules=("${in_modules[@]}") ;;
    -*)
      echo "unknown option $1; see --help" >&2
      exit 2
      ;;
    *)
      entries+=("$1")
      case " ${in_modules[*]} " in *" $1 "*) modules+=("$1") ;; esac
      ;;
  esac
  shift
done

command -v clang++ >/dev/null || {
  echo "skipped: no clang++ (tests/install_packages.sh)" >&2
  exit 77
}
cmake -C "$root/configs/presets/fuzzers.cmake" -S "$root" -B "$build" -G Ninja >/dev/null
# The modules that the build can have, among those with entries.
targets=(fuzz_parsers write_seeds)
there=()
for module in "${modules[@]}"; do
  if ninja -C "$build" -t query "voxweld_${module}_module" >/dev/null 2>&1; then
    targets+=("voxweld_${module}_module")
    there+=("$module")
  fi
done
cmake --build "$build" -j "$jobs" --target "${targets[@]}" >"$build/build.log" || {
  tail -50 "$build/build.log" >&2
  exit 1
}

# Lines "entry module"; the module is missing where the parser is in the program.
mapfile -t known < <(VOXWELD_PARSER='' "$build/fuzz_parsers" 2>&1 | tail -n +2)
names=$(printf '%s\n' "${known[@]}" | cut -d' ' -f1 | tr '\n' ' ')
if [ ${#entries[@]} -gt 0 ]; then
  require_known entry "$names" "${entries[@]}"
else
  for line in "${known[@]}"; do
    read -r name module <<<"$line"
    case " ${there[*]} " in *" ${module:-} "*) entries+=("$name") ;; esac
    [ -n "$module" ] || entries+=("$name")
  done
fi

scratch=$(mktemp -d "$([ -w /dev/shm ] && echo /dev/shm || echo "${TMPDIR:-/tmp}")/voxweld-fuzz-XXXXXX")
trap 'rm -rf "$scratch"' EXIT
mkdir -p "$finds" "$scratch/logs"
TMPDIR=$scratch "$build/write_seeds" "$scratch/seeds" "${program[@]}"

# fuzz ENTRY: until the time is over. libFuzzer ends with each find: then again, five times at most.
fuzz() {
  local entry=$1 end=$((SECONDS + seconds)) turn left leaks=1
  # HDF5 1.10 loses some bytes of each damaged dataset that it refuses (H5D__layout_oh_read).
  [ "$entry" != hdf5 ] || leaks=0
  mkdir -p "$build/corpus/$entry" "$scratch/seeds/$entry" "$scratch/tmp-$entry"
  local folders=("$build/corpus/$entry" "$scratch/seeds/$entry")
  [ ! -d "$root/tests/fuzz/finds/$entry" ] || folders+=("$root/tests/fuzz/finds/$entry")
  for turn in 1 2 3 4 5; do
    left=$((end - SECONDS))
    [ "$left" -gt 0 ] || break
    # The clock's limit is for inputs that wait; processor time is counted by the program. Modules
    # have copies of code that the program has as well.
    TMPDIR=$scratch/tmp-$entry VOXWELD_PARSER=$entry VOXWELD_MODULES=$build \
      ASAN_OPTIONS=detect_odr_violation=0:detect_leaks=$leaks UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1 \
      "$build/fuzz_parsers" -max_total_time="$left" -seed="$seed" -timeout=60 -report_slow_units=60 \
      -max_len=65536 -detect_leaks=$leaks -malloc_limit_mb=512 -rss_limit_mb=2048 -print_final_stats=1 -verbosity=1 \
      -artifact_prefix="$finds/$entry-" "${folders[@]}" \
      >"$scratch/logs/$entry.$turn" 2>&1 && break
    # What stopped it, where it is to be looked for.
    cp "$scratch/logs/$entry.$turn" "$finds/$entry-log-$turn"
    rm -rf "$scratch/tmp-$entry"/*
  done
  report "$entry"
}

report() {
  local entry=$1 runs coverage found
  runs=$(awk '/^stat::number_of_executed_units/ { n += $2 } END { print n + 0 }' "$scratch/logs/$entry".*)
  coverage=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$scratch/logs/$entry".* | sort -n | tail -1)
  found=$(grep -l 'Test unit written to' "$scratch/logs/$entry".* | wc -l)
  printf '%s %s %s %s\n' "$entry" "$runs" "${coverage:-0}" "$found" >"$scratch/logs/$entry.row"
}

export -f fuzz report
export root build scratch finds seconds seed
printf '%s\n' "${entries[@]}" | xargs -P "$jobs" -I{} bash -c 'fuzz {}'

printf '%-14s %12s %10s %6s\n' entry executions coverage finds
cat "$scratch"/logs/*.row | awk '
  { printf "%-14s %12d %10d %6d\n", $1, $2, $3, $4; runs += $2; finds += $4; idle += $2 == 0 }
  END { printf "%-14s %12d %10s %6d\n", "in all", runs, "", finds; exit finds > 0 || idle > 0 }' || {
  echo "what was found is in $finds, with the logs (also of what did not start)" >&2
  exit 1
}
