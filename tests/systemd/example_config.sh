#!/usr/bin/env bash
# Runs locd --check over the example configuration, as it is and with every field that it explains taken out of its
# comment; a capture stands in for the camera. Usage: example_config.sh EXAMPLE LOCD MAPBUILDER SIMULATOR
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export RUNTIME_DIRECTORY=$work STATE_DIRECTORY=$work

"$4" detections --scene room1 --rig cg120 --noise-px 0.1 -o "$work/capture" 2>/dev/null >/dev/null
"$3" build "$work/capture" -o "$work/hall.map" 2>/dev/null >/dev/null
(umask 077; printf '%064d\n' 0 >"$work/pose.key")
cp "$work"/capture/{rig.yaml,markers.toml} "$work"
# The example shows one camera; the rig has three.
{
  sed -e 's/^driver = "v4l2"/driver = "replay"/' -e 's/^device = .*/device = "capture"/' "$1"
  for camera in cam1 cam2; do
    printf '[[camera]]\nname = "%s"\ndriver = "replay"\ndevice = "capture"\n' $camera
  done
} >"$work/locd.toml"
"$2" --config "$work/locd.toml" --check

explained=$(grep -cE '^#[a-z_]+ = ' "$work/locd.toml")
[ "$explained" -ge 25 ] || { echo "the example explains only $explained optional fields"; exit 1; }
sed -E 's/^#([a-z_]+ = )/\1/' "$work/locd.toml" >"$work/all.toml"
"$2" --config "$work/all.toml" --check
