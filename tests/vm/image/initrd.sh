# The initial RAM disk, $OUT/initrd.img: busybox, the modules that mount the root in their order, and
# /overlay, which the first process lays over the root: the kernel's modules, our agent, settings. So
# that a change of ours costs a second, not a root file system.
here=$(cd "$(dirname "$0")" && pwd)
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/{bin,dev,modules,mnt,overlay}
cp /bin/busybox "$tree/bin/"
install -m 755 "$here/initrd_init.sh" "$tree/init"
for module in virtio_pci virtio_blk ext4; do
  modprobe -d "$KERNEL" -S "$KERNEL_RELEASE" --show-depends "$module" | awk '$1 == "insmod" { print $2 }'
done | awk '!seen[$0]++' | while read -r file; do
  cp "$file" "$tree/modules/"
  basename "$file" >>"$tree/modules.txt"
done

bash -euo pipefail "$here/overlay.sh" "$tree/overlay"
(cd "$tree" && find . | cpio --create --format newc --quiet) >"$OUT/initrd.img"
