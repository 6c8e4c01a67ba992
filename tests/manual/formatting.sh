#!/usr/bin/env bash
# The manual pages are formatted without a warning. Usage: formatting.sh MAN FOLDER
set -euo pipefail
for page in "$2"/*.[18]; do
  said=$(LC_ALL=C.UTF-8 MANROFFSEQ='' MANWIDTH=80 "$1" --warnings -E UTF-8 -l -Tutf8 -Z "$page" 2>&1 >/dev/null)
  [ -z "$said" ] || { echo "$page: $said"; exit 1; }
done
