# Functions of the tests that run lines of the documentation through real schedulers. Slurm is started on this machine for
# one test alone, and stopped again. To be sourced, after these are set: `page`, the page with the lines, and the PATH,
# on which the program and /usr/sbin must be.

missing=()
for pair in sbatch:slurm-wlm slurmctld:slurm-wlm slurmd:slurm-wlm munged:munge parallel:parallel; do
  command -v "${pair%%:*}" >/dev/null || missing+=("${pair##*:}")
done
if [ ${#missing[@]} -gt 0 ]; then
  echo "skipped; missing Debian packages: $(printf '%s\n' "${missing[@]}" | sort -u | paste -sd' ')"
  exit 77
fi

work=$(mktemp -d)
chmod 711 "$work"  # because munge's socket must be reachable
daemons=()
stop_all() {
  local status=$?
  set +e
  [ -n "${SLURM_CONF:-}" ] && scancel --quiet --user="$(id -un)" 2>/dev/null
  for ((i = ${#daemons[@]} - 1; i >= 0; --i)); do kill "${daemons[$i]}" 2>/dev/null; wait "${daemons[$i]}" 2>/dev/null; done
  if [ $status -ne 0 ]; then tail -n 15 "$work"/*.log "$work"/*/slurm-*.out 2>/dev/null; fi
  rm -rf "$work"
}
trap stop_all EXIT
trap 'exit 1' INT TERM HUP

start_slurm() {
  local host; host=$(hostname -s)
  local port=$((20000 + RANDOM % 20000))
  mkdir -p "$work/state" "$work/spool"
  head -c 1024 /dev/urandom >"$work/munge.key"
  chmod 400 "$work/munge.key"
  cat >"$work/slurm.conf" <<EOF
ClusterName=sweep
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$work/munge.socket
CredType=cred/munge
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=2,batch_sched_delay=0
SlurmdParameters=config_overrides
MailProg=/bin/true
MpiDefault=none
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
EOF
  export SLURM_CONF="$work/slurm.conf"
  munged --foreground --force --key-file="$work/munge.key" --socket="$work/munge.socket" --pid-file="$work/munge.pid" \
    --seed-file="$work/munge.seed" --log-file="$work/munged.log" 2>"$work/munged.err.log" &
  daemons+=($!)
  until [ -S "$work/munge.socket" ]; do kill -0 "${daemons[0]}"; sleep 0.1; done
  slurmctld -D -L "$work/slurmctld.log" 2>/dev/null &
  daemons+=($!)
  slurmd -D -L "$work/slurmd.log" 2>/dev/null &
  daemons+=($!)
  until sinfo --noheader --format=%t 2>/dev/null | grep -q idle; do
    for daemon in "${daemons[@]}"; do kill -0 "$daemon" || { echo "a daemon of Slurm ended" >&2; exit 1; }; done
    sleep 0.2
  done
}

# Prints the block below a heading of the page.
lines_of() { awk -v heading="$1" '$0 ~ "^#+ " heading "$" {on = 1} on && /^```/ {++fence; next} on && fence == 1 {print} fence == 2 {exit}' "$page"; }

run_lines() {  # FOLDER HEADING: runs the lines below the heading in a folder of their own
  mkdir -p "$work/$1"
  local lines; lines=$(lines_of "$2")
  [ -n "$lines" ] || { echo "$page has no lines below '$2'" >&2; exit 1; }
  (cd "$work/$1" && bash -euo pipefail -c "$lines" >"$work/$1.log" 2>&1) || { echo "failed: $2" >&2; exit 1; }
}
