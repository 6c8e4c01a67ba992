#!/usr/bin/env bash
# A vehicle's computer builds without tests, report page, Java, libcamera and bags: nothing that only these need is even
# looked for, and the programs' build is whole without them. Configures, builds nothing.
# Usage: build_options.sh CMAKE SOURCE CXX C
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$1" -S "$2" -B "$work" -G Ninja -DCMAKE_CXX_COMPILER="$3" -DCMAKE_C_COMPILER="$4" \
  -DWAYMARK_TESTS=OFF -DWAYMARK_REPORT_PAGE=OFF -DWAYMARK_JAVA=OFF -DWAYMARK_LIBCAMERA=OFF -DWAYMARK_BAGS=OFF >"$work/log" 2>&1 ||
  { cat "$work/log"; exit 1; }
! grep -E '^(GTest_DIR|NODE|NPM|CHROMIUM|JAVAC|LCM_JAR|LIBCAMERA_FOUND|LZ4_FOUND|SQLITE_FOUND|ZSTD_FOUND|USBREDIR_FOUND|CLANG_FORMAT)[:=]' "$work/CMakeCache.txt" ||
  { echo "looked for what only tests, page, Java, libcamera or bags need"; exit 1; }
ninja -C "$work" -t commands locd mapbuilder simulator >"$work/log" 2>&1 || { tail "$work/log"; exit 1; }
grep -q page_without_script "$work/log" || { echo "no page"; exit 1; }
! grep -qE 'npm|javac|make-jar|gtest' "$work/log" || { echo "still builds what was left out"; exit 1; }
