#!/bin/bash
# The same log in lock-step and through live processes ends in the same map.
# live.sh CONCORD WRITE_SESSION; exit code 77: skipped.
set -euo pipefail
concord=$1 write_session=$2

how=-n  # root needs no user namespace, which a chroot would refuse
[ "$(id -u)" = 0 ] && unshare -n true 2>/dev/null || how=-rn
unshare "$how" true 2>/dev/null || { echo 'skipped: network namespaces are not permitted here'; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$write_session" "$folder/log"

digest_of() { sed -n 's/.*"map_digest": "\([0-9a-f]*\)".*/\1/p'; }
lockstep=$("$concord" replay "$folder/log" --json | digest_of)
live=$(unshare "$how" bash -c 'ip link set lo up && ip route add 224.0.0.0/4 dev lo && exec "$@"' -- \
  "$concord" replay "$folder/log" --live --json | digest_of)
echo "lock-step $lockstep, live $live"
[ -n "$lockstep" ] && [ "$lockstep" = "$live" ]
