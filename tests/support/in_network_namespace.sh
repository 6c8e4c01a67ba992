#!/usr/bin/env bash
# Runs a command in a network namespace of its own, where multicast reaches only this command: no
# message of a test ever leaves it. Usage: in_network_namespace.sh COMMAND...
exec unshare --net -- bash -c '
  ip link set lo up multicast on && ip route add 239.0.0.0/8 dev lo && exec "$@"' _ "$@"
