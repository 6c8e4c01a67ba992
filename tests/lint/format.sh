#!/usr/bin/env bash
# Every C++ file is as clang-format writes it. Usage: format.sh CLANG_FORMAT ROOT
set -euo pipefail
cd "$2"
find bench core drivers locd mapbuilder simulator tests \( -name '*.h' -o -name '*.cc' \) -print0 2>/dev/null |
  xargs -0 "$1" --dry-run --Werror
