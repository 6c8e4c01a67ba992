#!/usr/bin/env bash
# Core and messages are installed, examples/ is copied to another folder, built against what is installed and run:
# on a map of a simulated room, on one of its images, and on locd's poses of it.
# Usage: installed_tree.sh CMAKE BUILD COMPILER EXAMPLES SIMULATOR MAPBUILDER LOCD [LCM_JAR]
set -euo pipefail
work=$(mktemp -d)
locd=
trap '[ -z "$locd" ] || kill -9 "$locd" 2>/dev/null || true; rm -rf "$work"' EXIT
url="udpm://239.255.76.67:7667?ttl=0"
failed() { echo "$1"; exit 1; }

for component in core messages; do
  "$1" --install "$2" --component $component --prefix "$work/prefix" >/dev/null
done
cp -r "$4" "$work/examples"
"$1" -S "$work/examples" -B "$work/build" -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_CXX_COMPILER="$3" >"$work/log" ||
  { cat "$work/log"; exit 1; }
"$1" --build "$work/build" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }
# Nothing that is installed names the folder that it was built in.
! grep -rlF "$2" "$work/prefix" --include='*.cmake' --include='*.pc' --include='*.h' || failed "names the build folder"

"$5" render --scene room1 --rig cg120 --positions 8 -o "$work/room" >/dev/null 2>&1
"$6" build "$work/room" -o "$work/room.map" --trajectory "$work/room.tum" >"$work/log" 2>&1 || { cat "$work/log"; exit 1; }

"$work/build/read_map" "$work/room.map" >"$work/markers"
"$6" info "$work/room.map" --json >"$work/info.json"
python3 - "$work/markers" "$work/info.json" <<'P'
import json, sys
lines = [line for line in open(sys.argv[1]) if line.startswith(("aruco", "tag"))]
markers = sum(submap["markers"] if isinstance(submap["markers"], int) else len(submap["markers"])
              for submap in json.load(open(sys.argv[2]))["submaps"])
assert len(lines) == markers and markers > 5, (len(lines), markers)
P
said=$("$work/build/read_map" "$work/room/rig.yaml" 2>&1) && failed "took a rig file for a map"
[[ $said == *rig.yaml* ]] || failed "$said"

# An image's own pose against the whole rig's, as mapbuilder has it: the map's frame, millimetres apart.
image=$(find "$work/room/cam0" -type f | sort | sed -n 4p)
"$work/build/localize_image" "$work/room.map" "$work/room/rig.yaml" 0 "$image" >"$work/pose"
python3 - "$work/pose" "$work/room.tum" "$(basename "${image%.*}")" <<'P'
import sys
pose = dict((line.split()[0], [float(word) for word in line.split()[1:]]) for line in open(sys.argv[1]))
stamp = int(sys.argv[3]) * 1e-9
rows = [[float(word) for word in line.split()] for line in open(sys.argv[2]) if not line.startswith("#")]
row = min(rows, key=lambda row: abs(row[0] - stamp))
assert abs(row[0] - stamp) < 1e-3, (row, stamp)
off = sum((a - b) ** 2 for a, b in zip(pose["position_m"], row[1:4])) ** 0.5
assert off < 0.005, off
P

{
  printf '[map]\npath = "room.map"\n[rig]\ncamchain = "room/rig.yaml"\n[lcm]\nurl = "%s"\n' "$url"
  for camera in cam0 cam1 cam2; do
    printf '[[camera]]\nname = "%s"\ndriver = "replay"\ndevice = "room"\n' $camera
  done
} >"$work/locd.toml"
export RUNTIME_DIRECTORY=$work STATE_DIRECTORY=$work
"$7" --config "$work/locd.toml" 2>"$work/log" &
locd=$!
timeout 60 "$work/build/listen_to_poses" "$url" 3 >"$work/heard" || { cat "$work/log"; exit 1; }
[ "$(grep -cE '^(OK|not OK) [0-9]+: ' "$work/heard")" -eq 3 ] || { cat "$work/heard"; exit 1; }
[ $# -ge 8 ] || exit 0
jars=$8:$work/prefix/share/java/waymark-types.jar
javac -cp "$jars" -d "$work/classes" "$work/examples/java/ListenToPoses.java"
timeout 60 java -Djava.net.preferIPv4Stack=true -cp "$jars:$work/classes" ListenToPoses "$url" 3 >"$work/heard"
[ "$(grep -cE '^(OK|not OK) [0-9]+: ' "$work/heard")" -eq 3 ] || { cat "$work/heard"; exit 1; }
