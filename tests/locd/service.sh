#!/usr/bin/env bash
# locd as a process: starts without a route for multicast, sends once there is one, resumes when it was
# lost, refuses a second instance, ends within a second.
# To be run in a network namespace of its own. Usage: service.sh LOCD SIMULATOR JAVA_CLASSPATH
set -euo pipefail
work=$(mktemp -d)
locd=
trap '[ -z "$locd" ] || kill -9 "$locd" 2>/dev/null || true; rm -rf "$work"' EXIT
url="udpm://239.255.76.67:7667?ttl=0"
export RUNTIME_DIRECTORY=$work STATE_DIRECTORY=$work

"$2" detections --scene room1 --rig cg120 --noise-px 0.1 -o "$work/room" >/dev/null 2>&1
{
  printf '[rig]\ncamchain = "room/rig.yaml"\n[lcm]\nurl = "%s"\n' "$url"
  for camera in cam0 cam1 cam2; do
    printf '[[camera]]\nname = "%s"\ndriver = "replay"\ndevice = "room"\n' $camera
  done
} >"$work/locd.toml"
"$1" --config "$work/locd.toml" --check >/dev/null 2>&1

hear_three_poses() {
  timeout 60 java -Djava.net.preferIPv4Stack=true -cp "$3" Listen "$url" WAYMARK 3 POSE >"$work/heard"
  [ "$(grep -c '^WAYMARK_POSE' "$work/heard")" -eq 3 ]
}

ip route del 239.0.0.0/8
"$1" --config "$work/locd.toml" 2>"$work/log" &
locd=$!
until grep -q session "$work/log"; do read -rt 0.1 <> <(:) || true; done
code=0
"$1" --config "$work/locd.toml" 2>"$work/second" || code=$?
[ "$code" -eq 69 ] || { echo "a second locd ended with $code"; cat "$work/second"; exit 1; }
grep -q "pid $locd;" "$work/second" || { cat "$work/second"; exit 1; }

# Another runtime folder makes it no other: the state folder is the same.
code=0
RUNTIME_DIRECTORY=$work/run "$1" --config "$work/locd.toml" 2>"$work/third" || code=$?
[ "$code" -eq 69 ] || { echo "a third locd ended with $code"; cat "$work/third"; exit 1; }
grep -q "pid $locd;" "$work/third" || { cat "$work/third"; exit 1; }

ip route add 239.0.0.0/8 dev lo
hear_three_poses "$@"
ip route del 239.0.0.0/8
read -rt 1 <> <(:) || true
ip route add 239.0.0.0/8 dev lo
hear_three_poses "$@"

begun=$(date +%s%N)
kill -TERM "$locd"
wait "$locd"
took_ms=$((($(date +%s%N) - begun) / 1000000))
locd=
[ "$took_ms" -lt 1000 ] || { echo "SIGTERM took $took_ms ms"; cat "$work/log"; exit 1; }
[ "$(wc -l <"$work/log")" -le 20 ] || { cat "$work/log"; exit 1; }
