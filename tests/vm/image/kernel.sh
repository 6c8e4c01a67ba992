# The stock kernel: $OUT/vmlinux and $OUT/lib/modules, with v4l2loopback built for it.
# (Debian's cloud kernel has no media drivers.)
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cd "$work"
apt-get download -qq -o APT::Sandbox::User=root "linux-image-$KERNEL_RELEASE=$KERNEL_VERSION" || {
  echo "the archive no longer holds the kernel of the installed headers, $KERNEL_VERSION:" \
       "apt-get update && apt-get install linux-headers-amd64"
  exit 1
}
mkdir unpacked
# Only what is used: modules of sound, network cards, disks … are most of the package.
dpkg-deb --fsys-tarfile linux-image-*.deb |
  tar -x -C unpacked --wildcards "./boot/vmlinuz-*" "./lib/modules/*/modules.*" \
    "./lib/modules/*/kernel/arch/*" "./lib/modules/*/kernel/crypto/*" "./lib/modules/*/kernel/fs/*" \
    "./lib/modules/*/kernel/lib/*" "./lib/modules/*/kernel/net/9p/*" \
    "./lib/modules/*/kernel/net/sched/sch_tbf.ko" "./lib/modules/*/kernel/drivers/block/*" \
    "./lib/modules/*/kernel/drivers/char/*" "./lib/modules/*/kernel/drivers/media/*" \
    "./lib/modules/*/kernel/drivers/net/dummy.ko" "./lib/modules/*/kernel/drivers/usb/*" \
    "./lib/modules/*/kernel/drivers/virtio/*"

tar -xjf /usr/src/v4l2loopback.tar.bz2
make -s -C "/usr/src/linux-headers-$KERNEL_RELEASE" M="$work/modules/v4l2loopback" modules
install -D -m 644 -t "unpacked/lib/modules/$KERNEL_RELEASE/extra" modules/v4l2loopback/v4l2loopback.ko
strip --strip-debug "unpacked/lib/modules/$KERNEL_RELEASE/extra/v4l2loopback.ko"

# Modules that are not in modules.txt, nor needed by those, go.
list=$(mktemp -p "$work")
depmod -b unpacked "$KERNEL_RELEASE" 2>/dev/null
sed 's/#.*//' "$here/modules.txt" | awk 'NF { print $1 }' | while read -r module; do
  modprobe -d "$work/unpacked" -S "$KERNEL_RELEASE" --show-depends "$module" | awk '$1 == "insmod" { print $2 }'
done | sort -u >"$list"
while read -r file; do
  install -D -m 644 "$file" "$OUT/${file#"$work/unpacked/"}"
done <"$list"
cp unpacked/lib/modules/"$KERNEL_RELEASE"/modules.{builtin,builtin.modinfo,order} "$OUT/lib/modules/$KERNEL_RELEASE/"
depmod -b "$OUT" "$KERNEL_RELEASE"
# Unpacked, it boots 6 s sooner under emulation.
"$here/extract_vmlinux.py" "unpacked/boot/vmlinuz-$KERNEL_RELEASE" "$OUT/vmlinux"
