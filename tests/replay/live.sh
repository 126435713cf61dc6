#!/bin/bash
# The same log in lock-step and through live processes ends in the same map, and in the same keys. It is a cut one: the
# stock player must play all whole events too.
# live.sh CONCORD WRITE_SESSION; exit code 77: skipped.
set -euo pipefail
concord=$1 write_session=$2

how=-n  # root needs no user namespace, which a chroot would refuse
[ "$(id -u)" = 0 ] && unshare -n true 2>/dev/null || how=-rn
unshare "$how" true 2>/dev/null || { echo 'skipped: network namespaces are not permitted here'; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$write_session" "$folder/whole"
head -c -10 "$folder/whole" >"$folder/log"

played=$folder/lockstep
replay() {
  local code=0
  "$@" >"$played" || code=$?
  [ "$code" = 4 ] || { cat "$played"; echo "exit code $code, not 4"; exit 1; }
}
replay "$concord" replay "$folder/log" --json
played=$folder/live
replay unshare "$how" bash -c 'ip link set lo up && ip route add 224.0.0.0/4 dev lo && exec "$@"' -- \
  "$concord" replay "$folder/log" --json --live

same() { diff <(sed -n "$1" "$folder/lockstep") <(sed -n "$1" "$folder/live"); }
same '/"\(digest\|map_digest\|map\|gaps\|messages\)"/p; /"cut": {/,/}/p'
same 's/^  "\([a-z_]*\)".*/\1/p'  # the keys
grep '"map_digest": "[0-9a-f]\{16\}"' "$folder/live"
grep '"gaps": \[\]' "$folder/live"
