#!/usr/bin/env bash
# Tries, as a program in locd's place would, what the unit is to shut: a line for each, "NAME open" or "NAME shut".
# To be run by a copy of the unit. Usage: holes.sh
state=/var/lib/locd

try() {
  local name=$1
  shift
  if "$@" >/dev/null 2>&1; then echo "$name open"; else echo "$name shut"; fi
}
writes() { : >"$1/waymark-was-here" && rm "$1/waymark-was-here"; }
sends_to() { echo >"/dev/udp/$1/9"; }
runs_what_it_wrote() { cp /usr/bin/true "$1/program" && chmod 700 "$1/program" && "$1/program"; }
# Not by execve, but by the loader, which maps the program into itself.
loads_what_it_wrote() { cp /usr/bin/true "$1/program" && /usr/lib64/ld-linux-x86-64.so.2 "$1/program"; }
connects_to() { perl -MIO::Socket::UNIX -e 'IO::Socket::UNIX->new($ARGV[0]) or exit 1' "$1"; }
# The number of a socket's family, in Linux.
opens_socket() { perl -e 'socket(my $socket, $ARGV[0], $ARGV[1], 0) or exit 1' "$1" "$2"; }
# Of System V, as others on the computer see it.
sees_shared_memory() { perl -e 'defined shmget(0x57415921, 4096, 0666) or exit 1'; }
# What is there already, so that nothing changes where it may.
writes_again() { bash -c 'was=$(cat "$1") && echo "$was" >"$1"' -- "$1"; }
sets_the_clock() { date --set="@$(date +%s)"; }

# What locd needs is open: else the rest proves nothing.
try own-state writes $state
try own-runtime writes /run/locd
try camera test -r /dev/waymark/WM-0
try own-group sends_to 239.255.76.67
try program-of-the-system /usr/bin/true
try notify test -S /run/systemd/notify

for folder in / /etc /etc/locd /usr /var /var/log /root /home /boot /dev/shm /dev/mqueue /run; do
  try "write:$folder" writes "$folder"
done
for folder in $state /run/locd /tmp; do
  try "execute:$folder" runs_what_it_wrote "$folder"
  try "load:$folder" loads_what_it_wrote "$folder"
done
for place in 127.0.0.1 192.168.77.9 239.1.2.3 224.0.0.251; do try "send:$place" sends_to "$place"; done
try bus connects_to /run/dbus/system_bus_socket
try shared-memory sees_shared_memory
try inet6 opens_socket 10 2
try packets opens_socket 17 2
try raw opens_socket 2 3
try disk test -r /dev/vda
try heap test -w /dev/dma_heap/system
try processes test -e /proc/1/comm
try namespace unshare --user true
try realtime chrt --fifo 1 true
try clock sets_the_clock
try name writes_again /proc/sys/kernel/hostname
try setuid sh -c "cp /usr/bin/true $state/program && chmod u+s $state/program"
try kernel writes_again /proc/sys/kernel/core_pattern
try many bash -c 'for i in {1..300}; do sleep 60 & done; [ "$(jobs -r | wc -l)" -eq 300 ] && kill $(jobs -p)'
rm -f $state/program
