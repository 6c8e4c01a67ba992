#!/usr/bin/env bash
# docs/scale.md without Slurm: an array of detection jobs, killed, started again and started twice, then one build: the map is
# equal, to the byte, to the one that one machine alone makes. Usage: detection_array.sh MAPBUILDER SIMULATOR
set -euo pipefail
mapbuilder=$1 simulator=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
mkdir alone

for task in 0 1 2; do
  "$simulator" render --scene room1 --rig cg120 --positions 4 --seed $((task + 1)) -o alone/round$task >/dev/null 2>&1
done
cp -r alone array
ls -d alone/* >alone.txt
ls -d array/* >captures.txt
# One machine alone, all of its processors.
for capture in $(cat alone.txt); do "$mapbuilder" detect "$capture" >/dev/null 2>&1; done
xargs -a alone.txt "$mapbuilder" build -o alone.map >/dev/null 2>&1

# The job script of docs/scale.md.
job() {
  local capture
  capture=$(sed -n "$((SLURM_ARRAY_TASK_ID + 1))p" captures.txt)
  "$mapbuilder" detect "$capture" --threads 1 >/dev/null 2>"log.$SLURM_ARRAY_TASK_ID.$BASHPID"
}
# Nodes that die: what is there afterwards is nothing, or whole.
for task in 0 1 2; do
  for after in 0.02 0.1 0.3; do
    capture=$(sed -n "$((task + 1))p" captures.txt)
    "$mapbuilder" detect "$capture" --threads 1 >/dev/null 2>&1 &
    victim=$!
    sleep $after
    kill -KILL $victim 2>/dev/null || true
    wait $victim 2>/dev/null || true
    [ ! -e "$capture/detections.csv" ] || tail -c 1 "$capture/detections.csv" | cmp - <(echo)
  done
done
# The array, with one task that was started twice.
jobs=()
for task in 0 1 2 1; do
  SLURM_ARRAY_TASK_ID=$task job &
  jobs+=($!)
done
for pid in "${jobs[@]}"; do wait "$pid" || { cat log.*; exit 1; }; done
cp array/round0/detections.csv first.csv
SLURM_ARRAY_TASK_ID=0 job
cmp first.csv array/round0/detections.csv
[ "$(wc -l <first.csv)" -gt 20 ]

xargs -a captures.txt "$mapbuilder" build -o array.map --threads 1 >/dev/null 2>"build.log" || { cat build.log; exit 1; }
cmp alone.map array.map
