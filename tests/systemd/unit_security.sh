#!/usr/bin/env bash
# Holds the unit's exposure at 1.6 or below, alone and with the real-time drop-in. Usage: unit_security.sh SYSTEMD_FOLDER
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# A drop-in is read after its unit: the same as the unit with it at its end.
cp "$1/locd.service" "$work/locd.service"
cat "$1/locd.service" "$1/realtime.conf" >"$work/locd-realtime.service"
for unit in locd locd-realtime; do
  systemd-analyze security --offline=true --threshold=16 "$work/$unit.service" >"$work/report" ||
    { cat "$work/report"; exit 1; }
  tail -n 1 "$work/report"
done

# Nothing in the unit that systemd does not understand; only the program is not installed here.
systemd-analyze verify "$work/locd.service" 2>&1 | grep -v 'locd is not executable' >"$work/verify" || true
[ ! -s "$work/verify" ] || { cat "$work/verify"; exit 1; }
