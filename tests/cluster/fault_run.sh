# A run of fault_test.sh: its driver and what runs beside it, and how both are judged. Sourced by it.
# shellcheck shell=bash
# shellcheck disable=SC2154 # names that fault_test.sh, faults.sh and changes.sh set

driver='' companion=''
declare -A injected runs first again lost unclear left_files # by kind

# start_driver: the run in place in the background, with `settings`; sets driver.
start_driver() {
  local arguments=() setting
  for setting in run.executor=slurm "${settings[@]}"; do
    arguments+=(--set "$setting")
  done
  log_begin=$(stat -c %s "$log" 2>/dev/null || echo 0)
  driver_config=$config_now driver_changes=$changes driver_origins=("$input_now.$config_now")
  "$voxweld" run "$place/scan.toml" "${arguments[@]}" >>"$log" 2>&1 &
  driver=$!
}

driver_lives() { kill -0 "$driver" 2>/dev/null; }
# Whether the driver has read its config: it has said something.
driver_has_begun() { [ "$(stat -c %s "$log")" -gt "$log_begin" ]; }

# note_input INPUT: what runs now may make its output of this one too.
note_input() {
  driver_origins+=("$1.$driver_config")
  [ -z "$companion" ] || companion_origins+=("$1.$companion_config")
}

# tend_nodes: what an administrator does. Slurm drains a node that runs a task with the id of a new
# one, as it comes to be where slurmctld lost what it had not saved, or whose tasks do not end.
tended=0
tend_nodes() {
  local node
  [ "$SECONDS" -ge $((tended + 5)) ] || return 0
  tended=$SECONDS
  for node in $(timeout 10 sinfo -h -N -t drain,drained -o %N 2>/dev/null); do
    timeout 10 scontrol update "nodename=$node" state=resume 2>/dev/null || true
  done
}

# finish PROCESS: waits for it; sets status. 124 and killed where it hangs.
finish() {
  local deadline=$((SECONDS + run_limit))
  while kill -0 "$1" 2>/dev/null; do
    if [ "$SECONDS" -ge "$deadline" ]; then
      squeue -r || true
      kill -9 "$1"
      wait "$1" 2>/dev/null || true
      status=124
      return
    fi
    tend_nodes
    sleep 0.1
  done
  status=0
  wait "$1" || status=$?
}

all_idle() { [ "$(timeout 10 sinfo -h -N -t idle -o %N 2>/dev/null | wc -l)" -eq "$nodes" ]; }
# What a run leaves in the queue must not meet the next.
calm_down() {
  local deadline=$((SECONDS + 90))
  left_tasks=$(timeout 20 squeue -h -r -t PD,R 2>/dev/null | wc -l || true)
  until all_idle && [ -z "$(timeout 10 squeue -h -t PD,R,CG 2>/dev/null)" ]; do
    timeout 20 scancel --user="$(id -un)" 2>/dev/null || true
    tend_nodes
    if [ "$SECONDS" -ge "$deadline" ]; then
      "$cluster" nodes
      scontrol show nodes | grep Reason || true
      fail "the cluster does not come to rest"
    fi
    sleep 0.5
  done
}

# wrong WHAT: the run is lost, and this is why.
wrong() {
  note+=" ($1)"
  result=lost
}

# verify MESH [OPTION...]
verify() {
  local mesh=$1
  shift
  "$voxweld" verify "$place/$mesh" "$@" >"$folder/verify" 2>&1 ||
    wrong "verify $mesh $*: $(tail -n 3 "$folder/verify" | paste -sd ';')"
}

# hold_to MESH ORIGIN...: an output directory must be of a clean run of one of these, and whole. The
# input and the config may have changed since.
hold_to() {
  local mesh=$1 origin hash
  shift
  hash=$(mesh_hash "$place/$mesh")
  for origin in "$@"; do
    [ "$hash" = "${reference[$origin]}" ] || continue
    verify "$mesh" --no-origin
    return 0
  done
  for origin in "${!reference[@]}"; do
    [ "$hash" != "${reference[$origin]}" ] || break
    origin=
  done
  wrong "$mesh: the bytes of ${origin:-no local run}, not of $*"
}

# failure_text LOG [BEGIN]: what a run says that gives up: its last error and what belongs to it.
failure_text() { tail -c "+$((${2:-0} + 1))" "$1" | tac | sed '/error: /q' | tac; }

# expect_clear KIND LOG [BEGIN]: a run that failed must say why.
expect_clear() {
  local text
  text=$(failure_text "$2" "${3:-0}")
  cut -c 1-300 <<<"$text" | head -n 8 | sed 's/^/          | /'
  is_clear "$1" "$text" || unclear[$kind]=$((unclear[$kind] + 1))
}

# strike MOST: until then, or until the driver has ended; counts them in struck.
strike() {
  while [ "$struck" -lt "$1" ] && driver_lives; do
    doze 300 4000
    driver_lives || return 0
    "inject_$kind" || continue
    struck=$((struck + 1))
    say "$name: $what"
  done
}

# finish_companion: sets alone, whether only the driver wrote its output, and broken, whether what ran
# beside it may have left less than it found there.
finish_companion() {
  alone=yes broken=no
  [ -n "$companion" ] || return 0
  finish "$companion"
  companion=
  [ "$companion_mesh" != mesh ] || alone=no
  [ -z "${VOXWELD_KEEP:-}" ] || cat "$companion_log" >>"$log.companions"
  if [ "$status" -gt 2 ]; then
    wrong "the run beside it: exit code $status"
  elif [ "$status" -ne 0 ]; then
    say "$name: the run beside it failed:"
    expect_clear any "$companion_log"
    broken=yes
  elif [ "$alone" = no ]; then
    driver_origins+=("${companion_origins[@]}")
  else
    hold_to "$companion_mesh" "${companion_origins[@]}"
  fi
}

# attempt MOST: the driver from start to end; sets status, and result where something is wrong.
attempt() {
  start_driver
  if [ "$kind" != memory ]; then
    [ "$reruns" -gt 0 ] || doze 0 9000 # any stage may be the first to be struck
    strike "$1"
  fi
  finish "$driver"
  driver=
  local driver_status=$status
  finish_companion
  status=$driver_status
  if [ "$status" -gt 2 ]; then
    wrong "exit code $status"
  elif [ "$status" -ne 0 ]; then
    expect_clear "$kind" "$log" "$log_begin"
    reruns=$((reruns + 1))
  elif [ "$alone" = yes ] || [ "$broken" = no ]; then
    hold_to mesh "${driver_origins[@]}"
  fi
}

# Whether the last driver saw nothing change: then its output is of the input and config there are.
settled() { [ "$status" -eq 0 ] && [ "$alone" = yes ] && [ "$driver_changes" -eq "$changes" ]; }

# one_run KIND FAULTS: a run that is struck up to that often, and begun again until it is done.
one_run() {
  kind=$1 struck=0 reruns=0 result=survived note='' settings=()
  runs[$kind]=$((runs[$kind] + 1))
  name=$kind-${runs[$kind]}
  place=$folder/$name
  [ "$kind" != disk ] || place=$small/$name
  log=$folder/$name.log
  mkdir -p "$place"
  put_scene
  if [ "$kind" = memory ]; then
    starve
    struck=1
    say "$name: $what"
  fi
  for (( ; ; )); do
    attempt "$2"
    settings=()
    [ "$result" != lost ] || break
    ! settled || break
    if [ "$reruns" -gt $((most_reruns + struck)) ]; then
      wrong "given up after $reruns reruns"
    fi
  done
  injected[$kind]=$((injected[$kind] + struck))
  count_left_files
  calm_down
  if [ "$result" != lost ]; then # nor has what was left in the queue written into it
    hold_to mesh "$input_now.$config_now"
    verify mesh
  fi
  tell_result
  rm -rf "$place"
}

count_left_files() {
  files=$(find "$place" -name '*.tmp-*' | wc -l)
  find "$place" -name '*.tmp-*' -printf '          | left: %P\n' | head -n 5
  left_files[$kind]=$((left_files[$kind] + files))
}

tell_result() {
  if [ "$result" = lost ]; then
    lost[$kind]=$((lost[$kind] + 1))
    tail -n 25 "$log"
  elif [ "$reruns" -eq 0 ]; then
    first[$kind]=$((first[$kind] + 1))
  else
    again[$kind]=$((again[$kind] + 1))
  fi
  say "$name: $result$note, $struck faults, $reruns reruns, $files temporary files and" \
    "$left_tasks tasks left"
  if [ -n "${VOXWELD_KEEP:-}" ]; then
    mkdir -p "$VOXWELD_KEEP"
    cp "$log" "$VOXWELD_KEEP/$seed-$name.log"
    [ ! -e "$log.companions" ] || cp "$log.companions" "$VOXWELD_KEEP/$seed-$name.companions.log"
    [ "$result" != lost ] || cp -a "$place" "$VOXWELD_KEEP/$seed-$name"
  fi
}
