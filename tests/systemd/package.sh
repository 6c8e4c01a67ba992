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
for file in ./usr/bin/locd ./usr/lib/systemd/system/locd.service \
  ./usr/lib/systemd/system/locd-again.timer ./usr/share/doc/waymark-locd/security.md ./usr/lib/udev/rules.d/61-waymark-cameras.rules \
  ./usr/lib/sysusers.d/waymark.conf ./usr/lib/tmpfiles.d/waymark.conf ./usr/lib/sysctl.d/60-waymark.conf \
  ./etc/locd/locd.toml ./usr/share/waymark-locd/realtime.conf \
  ./usr/bin/locdctl ./usr/share/man/man8/locd.8.gz ./usr/share/man/man1/locdctl.1.gz \
  ./usr/share/bash-completion/completions/locdctl ./usr/share/doc/waymark-locd/operations.md; do
  grep -qxF "$file" files || { echo "$package lacks $file"; exit 1; }
done
[ "$(cat control/conffiles)" = /etc/locd/locd.toml ]
for script in postinst prerm postrm; do sh -n "control/$script"; done
# What libcamera alone needs comes with it: locd's own package opens no memory to anybody.
! grep -rl dma_heap control || exit 1
dpkg-deb --fsys-tarfile "$package" | tar -xO ./usr/lib/udev/rules.d/61-waymark-cameras.rules \
  ./usr/lib/systemd/system/locd.service >locd_has
! grep dma_heap locd_has || exit 1
for libcamera in waymark-libcamera_*.deb; do
  dpkg-deb --fsys-tarfile "$libcamera" | tar -t >libcamera_files
  for file in ./usr/lib/udev/rules.d/62-waymark-libcamera.rules ./usr/lib/sysusers.d/waymark-libcamera.conf \
    ./usr/lib/systemd/system/locd.service.d/libcamera.conf; do
    grep -qxF "$file" libcamera_files || { echo "$libcamera lacks $file"; exit 1; }
  done
done
# Buffers of the whole machine's sockets stay as they are.
[ "$(dpkg-deb --fsys-tarfile "$package" | tar -xO ./usr/lib/sysctl.d/60-waymark.conf | grep -c '^net')" -eq 1 ]
# Installing enables and starts nothing; only a removal that failed starts again what it has stopped.
! sed '/^abort-remove)/,/;;/d' control/postinst | grep -E 'systemctl (enable|start|restart)' || exit 1
! grep '/multi-user.target.wants/' files || exit 1
# The vehicle needs neither other detectors nor video importers, and the tools load theirs from packages of their own.
! grep -E '(opencv|apriltag|libavcodec)' control/control || exit 1
dpkg-deb -e waymark-tools_*.deb tools_control
! grep -E '^Depends:.*(opencv|apriltag|libavcodec)' tools_control/control || exit 1
dpkg-deb --fsys-tarfile waymark-tools_*.deb | tar -t >tools_files
for file in ./usr/share/man/man1/mapbuilder.1.gz ./usr/share/man/man1/simulator.1.gz \
  ./usr/share/bash-completion/completions/mapbuilder; do
  grep -qxF "$file" tools_files || { echo "waymark-tools lacks $file"; exit 1; }
done
dpkg-deb --fsys-tarfile waymark-referees_*.deb | tar -t >referees_files
grep -qxF ./usr/lib/waymark/modules/libwaymark_referees.so referees_files
dpkg-deb --fsys-tarfile waymark-video_*.deb | tar -t >video_files
grep -qxF ./usr/lib/waymark/modules/libwaymark_video.so video_files
