# What fault_test.sh changes under a run: its input and its config; what clean local runs make of
# each; and another run beside it. Sourced by it.
# shellcheck shell=bash
# shellcheck disable=SC2034,SC2154 # names that fault_test.sh and fault_run.sh use and set

# Volumes of one size, so that one can be written over another.
inputs=3
# isovalue, tolerance, vertices of a tile
configs=("127.5 0.25 30000" "112 0.25 30000" "127.5 0.6 30000" "127.5 0.25 12000")

# write_config CONFIG FILE WORK MESH. The work is quick: each task's process is stopped most of its
# first two seconds, so that there is something to strike at. The merged mesh is what needs much
# memory.
write_config() {
  local isovalue tolerance tile_vertices
  read -r isovalue tolerance tile_vertices <<<"${configs[$1]}"
  cat >"$2" <<CONFIG
[input]
path = "scan.nrrd"
[work]
directory = "$3"
brick = 32
shard = 2
copy = true
[surface]
isovalue = $isovalue
inside = "below"
[simplify]
tolerance = $tolerance
[output]
directory = "$4"
tile_vertices = $tile_vertices
merged = true
[run]
memory = "700MiB"
[slurm]
cpus_per_task = 1
shards_per_task = 2
prologue = ["p=\$\$; (for i in {1..9}; do kill -STOP \$p; sleep 0.1; kill -CONT \$p; sleep 0.01; done) 2>/dev/null &"]
CONFIG
}

# make_inputs COUNT: input-0.nrrd and so on, in folder.
make_inputs() {
  local input
  for ((input = 0; input < $1; input++)); do
    "$voxweld" phantom porous --size 192 --type uint8 --seed $((input + 1)) \
      -o "$folder/input-$input.nrrd" >/dev/null
  done
}

# make_references INPUTS CONFIGS: sets reference[INPUT.CONFIG], the bytes of a local run, for the
# first so many of both.
declare -A reference
make_references() {
  local input config place=$folder/local
  make_inputs "$1"
  mkdir "$place"
  for ((input = 0; input < $1; input++)); do
    for ((config = 0; config < $2; config++)); do
      rm -rf "$place/work" "$place/mesh"
      cp "$folder/input-$input.nrrd" "$place/scan.nrrd"
      write_config "$config" "$place/scan.toml" work mesh
      "$voxweld" run "$place/scan.toml" --log-level warning >/dev/null
      reference[$input.$config]=$(mesh_hash "$place/mesh")
    done
  done
  rm -rf "$place"
}

# put_scene: input and config of a new run, in place.
put_scene() {
  input_now=0 config_now=0 changes=0
  cp "$folder/input-0.nrrd" "$place/scan.nrrd"
  write_config 0 "$place/scan.toml" work mesh
}

# roll_other NOW COUNT: sets rolled, to any below COUNT but NOW.
roll_other() {
  roll 1 $(($2 - 1))
  rolled=$((($1 + rolled) % $2))
}

# write_over INPUT: in place, which takes a moment; the file stays the same file.
write_over() { dd if="$folder/input-$1.nrrd" of="$place/scan.nrrd" conv=notrunc bs=256K status=none; }

# The run's input changes while it may be read. What is running may have seen it before and after.
inject_input() {
  local volume=$place/scan.nrrd new=$place/new.nrrd before=$place/before other
  roll_other "$input_now" "$inputs"
  other=$rolled
  touch -r "$volume" "$before"
  changes=$((changes + 1))
  roll 0 5
  case $rolled in
    0 | 1)
      cp "$folder/input-$other.nrrd" "$new"
      [ "$rolled" -eq 0 ] || touch -r "$before" "$new"
      note_input "$other"
      mv "$new" "$volume"
      what="replaced by volume $other"
      [ "$rolled" -eq 0 ] || what+=", of the same time"
      ;;
    2 | 3)
      note_input "$other"
      write_over "$other"
      what="volume $other written over it"
      if [ "$rolled" -eq 3 ]; then
        touch -r "$before" "$volume"
        what+=", its time set back"
      fi
      ;;
    4)
      other=$input_now
      touch "$volume"
      what="touched"
      ;;
    5)
      other=$input_now
      roll_other "$input_now" "$inputs"
      what="volume $rolled written over it"
      note_input "$rolled"
      write_over "$rolled"
      doze 0 2000
      write_over "$other"
      what+=", and the old one $dozed s later"
      ;;
  esac
  rm -f "$before"
  input_now=$other
  note_input "$other"
}

# The config changes, for the next start of the driver or with a new start at once; or another run
# begins beside the one under way.
inject_config() {
  driver_has_begun || return 1
  roll 0 6
  case $rolled in
    0) change_config && what="becomes config $config_now, for the next start" ;;
    1) restart_with_other_config KILL ;;
    2) restart_with_other_config TERM ;;
    3) start_companion slurm scan.toml "$config_now" mesh ;;
    4) start_companion local scan.toml "$config_now" mesh ;;
    5) start_neighbour slurm ;;
    6) start_neighbour local ;;
  esac
}

change_config() {
  roll_other "$config_now" "${#configs[@]}"
  config_now=$rolled
  changes=$((changes + 1))
  write_config "$config_now" "$place/scan.toml" work mesh
}

restart_with_other_config() {
  kill "-$1" "$driver" 2>/dev/null || return 1
  [ "$1" != KILL ] || wait "$driver" 2>/dev/null || true
  finish "$driver"
  change_config
  doze 0 2000
  start_driver
  what="becomes config $config_now; the driver, ended by SIG$1, starts again after $dozed s"
}

# start_neighbour EXECUTOR: a run of another config, which shares the work and has its own output.
start_neighbour() {
  roll 0 $((${#configs[@]} - 1))
  [ -z "$companion" ] || return 1
  write_config "$rolled" "$place/other.toml" work other.mesh
  start_companion "$1" other.toml "$rolled" other.mesh
}

# start_companion EXECUTOR FILE CONFIG MESH: a run beside the driver's, if there is none yet.
start_companion() {
  [ -z "$companion" ] || return 1
  companion_log=$log.beside companion_config=$3 companion_mesh=$4
  companion_origins=("$input_now.$3")
  "$voxweld" run "$place/$2" --set "run.executor=$1" >"$companion_log" 2>&1 &
  companion=$!
  what="a run of config $3 begins beside it, executor $1, into $4"
}
