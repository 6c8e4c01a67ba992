#!/bin/busybox sh
# First process: loads what the root's disk needs, mounts it, lays our files over it, hands over.
b=/bin/busybox
$b mount -t devtmpfs dev /dev
for module in $($b cat /modules.txt); do $b insmod /modules/$module; done
until [ -b /dev/vda ]; do $b sleep 0.05; done
$b mount -t ext4 -o rw,noatime /dev/vda /mnt
$b cp -a /overlay/. /mnt/
$b mount --move /dev /mnt/dev
exec $b switch_root /mnt /sbin/init
