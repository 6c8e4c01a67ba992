#!/usr/bin/env bash
# What bash offers behind some beginnings. Usage: completion.sh COMPLETION LOCD LOCDCTL MAPBUILDER SIMULATOR
set -euo pipefail
source "$1"

# offers PROGRAM WANTED WORD…: what is offered for the last word.
offers() {
  local program=$1 wanted=$2
  shift 2
  COMP_WORDS=("$program" "$@") COMP_CWORD=$# COMPREPLY=()
  _waymark "$program" "${@: -1}"
  [ "${COMPREPLY[*]}" = "$wanted" ] || { echo "$program $*: '${COMPREPLY[*]}' instead of '$wanted'"; exit 1; }
}

offers "$2" "--list-cameras" --li
offers "$3" "calibration" ca
offers "$3" "--output" calibration --out
offers "$4" "build" bu
offers "$4" "--report" build capture --rep
offers "$5" "render" re
offers "$5" "--positions" render --pos
offers "$4" "" build hall
