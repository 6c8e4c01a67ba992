#!/usr/bin/env bash
# Every C++ file is as clang-format writes it. Usage: format.sh CLANG_FORMAT ROOT
set -euo pipefail
cd "$2"
folders=()
for folder in bench cmake core drivers examples locd mapbuilder simulator tests; do
  [ -d "$folder" ] && folders+=("$folder")
done
find "${folders[@]}" \( -name '*.h' -o -name '*.cc' \) -print0 | xargs -0 "$1" --dry-run --Werror
