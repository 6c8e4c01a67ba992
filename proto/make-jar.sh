#!/usr/bin/env bash
# Java classes of messages. Usage: make-jar.sh LCM_GEN LCM_JAR OUTPUT.jar TYPE.lcm...
set -euo pipefail
lcm_gen=$1 lcm_jar=$2 output=$3
shift 3

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$lcm_gen" --java --jpath "$work/source" "$@"
# Also for programs on older Java than the one that compiles here.
javac --release 8 -Xlint:-options -nowarn -cp "$lcm_jar" -d "$work/classes" "$work"/source/waymark/*.java
jar --create --file "$output" -C "$work/classes" .
