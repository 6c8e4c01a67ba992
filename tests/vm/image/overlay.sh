# What lies over the guest's packages, filled into a folder. Usage: overlay.sh FOLDER
here=$(cd "$(dirname "$0")" && pwd)
overlay=$1
units=$overlay/etc/systemd/system
mkdir -p "$overlay"/usr/{lib,local/sbin} "$units/sysinit.target.wants"
cp -a "$KERNEL/lib/modules" "$overlay/usr/lib/"

echo waymark-vm >"$overlay/etc/hostname"
# A machine-id that is there saves 5 s of a first boot.
echo 0123456789abcdef0123456789abcdef >"$overlay/etc/machine-id"
echo 'share /share 9p noauto,trans=virtio,version=9p2000.L,msize=262144' >"$overlay/etc/fstab"
install -m 755 "$here/guest/waymark-agent" "$overlay/usr/local/sbin/"
install -m 644 "$here/guest/waymark-agent.service" "$units/"
ln -s ../waymark-agent.service "$units/sysinit.target.wants/"

# An emulated machine is 10 to 40 times slower than a vehicle's: what is stuck there must not move for longer.
mkdir "$units/locd.service.d"
printf '[Service]\nTimeoutStartSec=120s\nTimeoutStopSec=60s\nWatchdogSec=30s\n' >"$units/locd.service.d/emulation.conf"

# What no test needs and every boot would wait for.
for unit in apt-daily.timer apt-daily-upgrade.timer dpkg-db-backup.timer e2scrub_all.timer fstrim.timer \
            systemd-tmpfiles-clean.timer \
            dev-hugepages.mount dev-mqueue.mount proc-sys-fs-binfmt_misc.automount \
            sys-fs-fuse-connections.mount sys-kernel-debug.mount sys-kernel-tracing.mount \
            systemd-networkd.socket systemd-rfkill.socket; do
  ln -s /dev/null "$units/$unit"
done
for service in e2scrub_reap getty@tty1 ldconfig modprobe@configfs modprobe@dm_mod modprobe@drm \
               modprobe@efi_pstore modprobe@fuse modprobe@loop rc-local serial-getty@ttyS0 systemd-binfmt \
               systemd-firstboot systemd-hwdb-update systemd-journal-catalog-update systemd-journal-flush \
               systemd-logind systemd-machine-id-commit systemd-network-generator systemd-networkd \
               systemd-pstore systemd-random-seed systemd-sysusers systemd-timesyncd systemd-update-done \
               systemd-update-utmp systemd-user-sessions; do
  ln -s /dev/null "$units/$service.service"
done
ln -s /lib/systemd/system/multi-user.target "$units/default.target"
