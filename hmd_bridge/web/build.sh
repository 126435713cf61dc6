#!/bin/sh
# build.sh NPM NODE OUT TESTS PYTHON: the packages, the page, its tests, its types checked. Where npm's registry is out of reach nothing is
# made, and the rest of Concord is built all the same; the next build tries again.
set -eu
npm=$1 node=$2 out=$3 tests=$4 python=$5
cd "$(dirname "$0")"
modules=node_modules/.package-lock.json
if [ ! -f "$modules" ] || [ package-lock.json -nt "$modules" ]; then
  if ! "$npm" ci --ignore-scripts --no-audit --no-fund --loglevel=error; then
    echo 'concord: the web client is NOT built: npm did not bring its packages (see above)' >&2
    exit 0
  fi
  touch "$modules"
fi
"$node" build.mjs --out "$out" --tests "$tests" --python "$python"
exec "$node" node_modules/typescript/bin/tsc
