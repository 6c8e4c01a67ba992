#!/bin/sh
# CPU seconds per image at `still`, from two runs of different length so that preparation cancels.
# usage: bench/simulator_render_speed.sh path/to/simulator [scene [rig]]
set -eu
simulator=$1
scene=${2:-warehouse}
rig=${3:-cg120}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cpu_s() {
  ( TIMEFORMAT='%U %S'; export TIMEFORMAT
    bash -c "time $simulator render --scene $scene --rig $rig --positions $1 -o $work/$1 >$work/out 2>/dev/null" ) 2>&1 |
    awk '{ print $1 + $2 }'
}
short=$(cpu_s 5)
long=$(cpu_s 25)
images=$(( $(find "$work/25" -name '*.jpg' | wc -l) - $(find "$work/5" -name '*.jpg' | wc -l) ))
cat "$work/out"
awk "BEGIN { s = ($long - $short) / $images; printf \"%s %s: %.1f ms CPU per image: %.1f images/s on two free cores\n\", \"$scene\", \"$rig\", 1000 * s, 2 / s }"
