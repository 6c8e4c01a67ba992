#!/usr/bin/env bash
# What the packages of a build folder bring along on a minimal Debian 12 (its required packages and apt, nothing else), by a
# simulated installation. Usage: closure.sh BUILD_FOLDER. 77 where apt knows no packages.
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
apt-cache show systemd >/dev/null 2>&1 || { echo "apt knows no packages: apt-get update never ran"; exit 77; }
cpack -G DEB --config "$1/CPackConfig.cmake" >log 2>&1 || { cat log; exit 1; }

simulate() { apt-get -q -s -o Dir::State::status="$work/status" -o APT::Sandbox::User=root --no-install-recommends install "$@"; }
installed() { awk '/^Inst /{print $2}' | sort -u; }
: >status
required=$(apt-cache dumpavail | awk '/^Package:/{name=$2} /^Priority: required|^Essential: yes/{print name}' | sort -u)
base=$(simulate $required apt | installed)
apt-cache show --no-all-versions $base >shown
awk '/^Package:/{print; print "Status: install ok installed"; next}
     /^(Version|Architecture|Multi-Arch|Depends|Pre-Depends|Provides|Conflicts|Breaks|Replaces|Priority|Essential|Maintainer|Description):/{print}
     /^$/{print}' shown >status

# held PACKAGE MOST_PACKAGES MOST_MB: of itself and all that it brings along.
held() {
  local deb=$work/$1_*.deb others count kb
  others=$(simulate $deb | installed | grep -vx "$1")
  count=$(($(echo "$others" | wc -l) + 1))
  kb=$({ apt-cache show --no-all-versions $others; dpkg-deb -f $deb Installed-Size | sed 's/^/Installed-Size: /'; } |
    awk '/^Installed-Size:/{sum += $2} END{print sum}')
  echo "$1: $count packages, $((kb / 1000)) MB"
  [ "$count" -le "$2" ] && [ "$kb" -le $(($3 * 1000)) ] || { echo "more than $2 packages or $3 MB:" $others; exit 1; }
  ! echo "$others" | grep -Ei 'opencv|apriltag|qt5|gdal|llvm|avcodec' || exit 1
}
held waymark-locd 25 45
held waymark-tools 60 120
