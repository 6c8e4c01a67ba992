#!/usr/bin/env bash
# A Java program with the shipped jar prints the values that C++ published.
# Usage: java_decodes.sh CLASSPATH PUBLISH_SAMPLES EXPECTED
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
url="udpm://239.255.76.67:7667?ttl=0"

mkfifo "$work/heard"
java -Djava.net.preferIPv4Stack=true -cp "$1" Listen "$url" WAYMARK 5 >"$work/heard" &
{
  read -r ready
  [ "$ready" = listening ]
  "$2" "$url"
  # Channels come in the order in which they were published.
  cat
} <"$work/heard" >"$work/decoded"
wait
diff -u "$3" "$work/decoded"
