#!/usr/bin/env bash
# The installed messages serve programs that know only CMake's find_package or pkg-config.
# Usage: installed_package.sh CMAKE BUILD COMPILER CONSUMER WITH_JAVA
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$1" --install "$2" --component messages --prefix "$work/prefix" >/dev/null
"$1" -S "$4" -B "$work/build" -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_CXX_COMPILER="$3" >/dev/null
"$1" --build "$work/build" >/dev/null
"$work/build/consumer"

pkgconfig=$(dirname "$(find "$work/prefix" -name waymark-messages.pc)")
# shellcheck disable=SC2046  # several words
"$3" -std=c++17 "$4/consumer.cc" \
  $(PKG_CONFIG_PATH="$pkgconfig" pkg-config --cflags --libs waymark-messages) -o "$work/by-pkg-config"
"$work/by-pkg-config"

[ "$5" -eq 1 ] || exit 0
[ -f "$work/prefix/share/java/waymark-types.jar" ]
# Without Java's jars, waymark-spy says what to install.
said=$(WAYMARK_JAVA_FOLDER="$work/none" "$work/prefix/bin/waymark-spy" 2>&1) && exit 1
[[ $said == *"install liblcm-java"* ]]
