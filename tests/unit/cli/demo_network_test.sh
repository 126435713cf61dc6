#!/usr/bin/env bash
# demo_network_test.sh RUN: `./run concord` finds the network of a running demo, whatever became of others. RUN stands in
# a folder of its own here, with a program in place of `concord` that says which network it is in.
set -eu
unshare -n true 2>/dev/null || { echo 'network namespaces are not permitted here'; exit 77; }
top=$(mktemp -d)
trap 'exec 3>&- 4>&-; wait; rm -rf "$top"' EXIT
cp "$1" "$top/run"
mkdir -p "$top/build/bin"
printf 'rule none\n  command = true\nbuild modules/all: phony\nbuild planner/all: phony\nbuild hmd_bridge/all: phony\n' >"$top/build/build.ninja"
cat >"$top/build/bin/concord" <<'END'
#!/usr/bin/env bash
[ "${1:-}" != demo ] || { [ "$2" != refused ] || exit 2; readlink /proc/self/ns/net >"$2"; read -r _ <"$3" || true; exit 0; }
readlink /proc/self/ns/net
END
chmod +x "$top/build/bin/concord"

fail() { echo "$1"; cat "$top/said"; exit 1; }
joins() { [ "$("$top/run" concord where 2>"$top/said")" = "$1" ] || fail "not in the network of $2"; }
says() { grep -q "$1" "$top/said" || fail "nothing said like: $1"; }
# A demo NAME: says its network through the one pipe and lasts until the other is closed.
demo() { mkfifo "$top/$1.net" "$top/$1.end"; "$top/run" demo "$top/$1.net" "$top/$1.end" >/dev/null 2>&1 & }

here=$(readlink /proc/self/ns/net)
joins "$here" 'this shell: no demo runs'
[ ! -s "$top/said" ] || fail 'something was said'

demo first; first=$!; first_net=$(cat "$top/first.net"); exec 3>"$top/first.end"
joins "$first_net" 'the first demo'
"$top/run" demo refused >/dev/null 2>&1 && fail 'not refused'
joins "$first_net" 'the first demo, after another was refused'

demo second; second=$!; second_net=$(cat "$top/second.net"); exec 4>"$top/second.end"
joins "$second_net" 'the demo that began last'
says "2 demos run here.*process $second"
kill -9 "$second"; wait "$second" 2>/dev/null || true
joins "$first_net" 'the demo that is left'
echo 1 >"$top/build/demos/$$"  # this shell's id, used by a demo once
joins "$first_net" 'the demo, not a process that has the id of one that ended'
[ "$(ls "$top/build/demos")" = "$first" ] || fail 'files of ended demos are left'

mkdir "$top/bin"; printf '#!/bin/sh\nexit 1\n' >"$top/bin/nsenter"; chmod +x "$top/bin/nsenter"
status=0; PATH=$top/bin:$PATH "$top/run" concord where >"$top/where" 2>"$top/said" || status=$?
{ [ "$status" = 2 ] && [ ! -s "$top/where" ]; } || fail 'fell back, though a demo runs'
says "process $first.*cannot be joined"

exec 3>&-; wait "$first"
joins "$here" 'this shell: the demo has ended'
says 'has ended'
