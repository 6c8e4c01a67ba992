#!/usr/bin/env bash
# Purges in a mount namespace of its own: what is mounted in the folder of recordings is not touched, however it is
# mounted, and only then is that said. Usage: purge.sh POSTRM
set -euo pipefail
if [ "${2:-}" != inside ]; then
  # Mounting is for root; anybody is root of a user namespace of his own.
  who=()
  [ "$(id -u)" = 0 ] || who=(--user --map-root-user)
  exec unshare "${who[@]}" --mount -- "$0" "$1" inside
fi
postrm=$(readlink -f "$1")
state=/var/lib/locd
mount -t tmpfs tmpfs /run
mount -t tmpfs tmpfs /var/lib
[ ! -d /etc/systemd ] || mount -t tmpfs tmpfs /etc/systemd

die() { echo "$case: $*"; exit 1; }
# A state folder with two recordings, and a disk beside it that holds another.
begin() {
  case=$1
  umount -R /var/lib && mount -t tmpfs tmpfs /var/lib
  mkdir -p $state/recordings/{1,2}/cam0 /run/locd /var/lib/disk/recordings/3/cam0
  echo image | tee $state/recordings/{1,2}/cam0/1.pgm /var/lib/disk/recordings/3/cam0/1.pgm >$state/quarantine.json
  echo 1 >/run/locd/locd.pid
}
purge() { said=$(sh "$postrm" purge 2>&1) || die "it fails: $said"; }
gone() { [ ! -e "$1" ] || die "$1 is not deleted; said: $said"; }
kept() { [ -s "$1" ] || die "$1 is deleted; said: $said"; }
says_mounted() { [[ $said == *"$state stays, for something is mounted in it: $1 "* ]] || die "says: $said"; }
says_nothing() { [ -z "$said" ] || die "says: $said"; }

begin "nothing is mounted"
purge && says_nothing
gone $state && gone /run/locd && kept /var/lib/disk/recordings/3/cam0/1.pgm

begin "a disk at the state folder"
mount -t tmpfs tmpfs $state && mkdir -p $state/recordings/3/cam0 && echo image >$state/recordings/3/cam0/1.pgm
purge && says_mounted $state
kept $state/recordings/3/cam0/1.pgm && gone /run/locd

begin "a folder of the same disk at the state folder"
mount --bind /var/lib/disk $state
purge && says_mounted $state
kept $state/recordings/3/cam0/1.pgm && kept /var/lib/disk/recordings/3/cam0/1.pgm

begin "a folder of the same disk at the recordings"
mount --bind /var/lib/disk/recordings $state/recordings
purge && says_mounted $state/recordings
kept /var/lib/disk/recordings/3/cam0/1.pgm && kept $state/quarantine.json

begin "a disk at the recordings"
mount -t tmpfs tmpfs $state/recordings && echo image >$state/recordings/of-another-disk
purge && says_mounted $state/recordings
kept $state/recordings/of-another-disk

begin "a folder of the same disk deep within"
mkdir $state/recordings/1/cam0/deep
mount --bind /var/lib/disk $state/recordings/1/cam0/deep
purge && says_mounted $state/recordings/1/cam0/deep
kept /var/lib/disk/recordings/3/cam0/1.pgm && kept $state/recordings/2/cam0/1.pgm

begin "a file is mounted over another"
mount --bind /var/lib/disk/recordings/3/cam0/1.pgm $state/recordings/1/cam0/1.pgm
purge && says_mounted $state/recordings/1/cam0/1.pgm
kept /var/lib/disk/recordings/3/cam0/1.pgm

begin "a neighbour whose name begins alike"
mkdir /var/lib/locd-old && mount -t tmpfs tmpfs /var/lib/locd-old
purge && says_nothing
gone $state

begin "the state folder is a link to a disk"
rm -r $state && ln -s disk $state
purge
kept /var/lib/disk/recordings/3/cam0/1.pgm

begin "a link within"
ln -s ../../disk/recordings/3 $state/recordings/link
purge && says_nothing
gone $state && kept /var/lib/disk/recordings/3/cam0/1.pgm

begin "the disk is read-only"
mount -o remount,bind,ro /var/lib
purge
[[ $said == *Read-only* && $said != *mounted* ]] || die "says: $said"
echo "eleven purges"
