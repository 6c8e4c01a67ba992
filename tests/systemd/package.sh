#!/usr/bin/env bash
# Builds the Debian packages of a build folder and holds them to what they promise. Usage: package.sh BUILD_FOLDER
set -euo pipefail
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

cpack -G DEB --config "$1/CPackConfig.cmake" >log 2>&1 || { cat log; exit 1; }
for package in waymark-*.deb; do
  lintian --allow-root --fail-on error "$package"
done
package=$(echo waymark-locd_*.deb)
dpkg-deb --fsys-tarfile "$package" | tar -t >files
dpkg-deb -e "$package" control
for file in ./usr/bin/locd ./usr/lib/systemd/system/locd.service ./usr/lib/udev/rules.d/61-waymark-cameras.rules \
  ./usr/lib/sysusers.d/waymark.conf ./usr/lib/tmpfiles.d/waymark.conf ./usr/lib/sysctl.d/60-waymark.conf \
  ./etc/locd/locd.toml ./usr/share/waymark-locd/realtime.conf \
  ./usr/share/doc/waymark-locd/operations.md; do
  grep -qxF "$file" files || { echo "$package lacks $file"; exit 1; }
done
[ "$(cat control/conffiles)" = /etc/locd/locd.toml ]
for script in postinst prerm postrm; do sh -n "control/$script"; done
# Installing enables and starts nothing; only a removal that failed starts again what it has stopped.
! sed '/^abort-remove)/,/;;/d' control/postinst | grep -E 'systemctl (enable|start|restart)' || exit 1
! grep '/multi-user.target.wants/' files || exit 1
# The vehicle needs neither video importers nor windows.
! grep -E '(opencv-(videoio|highgui|imgcodecs)|libavcodec)' control/control || exit 1
