#!/usr/bin/env bash
# Holds the unit's exposure at 1.4 or below, also with what libcamera needs, and at 1.6 with the real-time drop-in; and
# what ends a start for good. Usage: unit_security.sh SYSTEMD_FOLDER
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# A drop-in is read after its unit: the same as the unit with it at its end.
cp "$1/locd.service" "$1/locd-again.timer" "$work"
cat "$1/locd.service" "$1/libcamera.conf" >"$work/locd-libcamera.service"
cat "$1/locd.service" "$1/realtime.conf" >"$work/locd-realtime.service"
for unit_and_most in locd:14 locd-libcamera:14 locd-realtime:16; do
  unit=${unit_and_most%:*}
  systemd-analyze security --offline=true "--threshold=${unit_and_most#*:}" "$work/$unit.service" >"$work/report" ||
    { cat "$work/report"; exit 1; }
  tail -n 1 "$work/report"
done

# Nothing in the units that systemd does not understand; only the program is not installed here.
systemd-analyze verify "$work/locd.service" "$work/locd-again.timer" 2>&1 | grep -v 'locd is not executable' \
  >"$work/verify" || true
[ ! -s "$work/verify" ] || { cat "$work/verify"; exit 1; }

# Nothing ends for good but by systemctl: what ends in order is restarted; what only a change mends is the timer's.
for line in Restart=always OnFailure=locd-again.timer; do
  grep -qxF "$line" "$1/locd.service" || { echo "locd.service lacks $line"; exit 1; }
done
! grep -q '^StartLimit.*=[1-9]' "$1/locd.service"
grep -qxF Unit=locd.service "$1/locd-again.timer"
