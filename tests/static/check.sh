#!/usr/bin/env bash
# Rules of the house that a compiler does not know. `check.sh RULE`: exit 0 kept, 1 broken (each place is named), 77 skipped.
set -u
cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../.." || exit 2

sources() { find "$@" -name node_modules -prune -o -type f \( -name '*.cpp' -o -name '*.hpp' \) -print | LC_ALL=C sort; }

# none WHAT: fails when standard input has a line, and shows it.
none() {
  local places; places=$(cat)
  [ -z "$places" ] && return 0
  printf '%s:\n%s\n\n' "$1" "$places"
  return 1
}

# A shell talks to the outside: nodes and their queues, streams and stores, the process frame, programs, what measures a
# scenario. All else in a process's folder is its pure core.
is_shell='(_(node|store|streams|queue)\.[ch]pp|/main\.cpp|^modules/(bus|cli|agent|store)/|^planner/scenario/)'

dependencies() {
  local failed=0 process
  sources modules planner hmd_bridge | xargs -r grep -HnE '#include <lcm/' | grep -v '^modules/bus/' |
    none 'LCM outside modules/bus' || failed=1
  sources modules planner hmd_bridge | xargs -r grep -HnE '#include <concord/.*_t\.hpp>' | grep -v '^modules/bus/' |
    none 'generated message types outside the translators in modules/bus' || failed=1
  sources modules planner | grep -vE "$is_shell" | xargs -r grep -HnE '#include (<(spdlog|CLI|sqlite3)|"(bus|store)/)' |
    none 'a core that logs, parses arguments, stores or talks' || failed=1
  sources modules planner | grep -vE "$is_shell" | xargs -r grep -HnE '(system|steady|high_resolution)_clock|gettimeofday|[^_.>]time\(' |
    none 'a core that reads a clock' || failed=1
  sources hmd_bridge/protocol hmd_bridge/session hmd_bridge/view hmd_bridge/mapper |
    xargs -r grep -HnE '#include (<(spdlog|CLI|sqlite3|boost|openssl)|"(bus|store|bridge|server|client)/)|(system|steady)_clock' |
    none 'a core of hmd_bridge that logs, talks, stores or reads a clock' || failed=1
  sources modules/core | xargs -r grep -HnE '#include "' | grep -v '#include "core/' |
    none 'modules/core knows only itself' || failed=1
  sources modules/bus modules/store | xargs -r grep -HnE '#include "' | grep -vE '#include "(core|bus|store)/' |
    none 'modules/bus and modules/store know modules/core and themselves' || failed=1
  for process in ingest align merge semantic planner; do
    sources modules planner | grep -E "^(modules/)?$process/" | xargs -r grep -HnE '#include "[a-z_]+/' |
      grep -vE "#include \"($process|core|bus|store)/" |
      none "$process includes another process" || failed=1
  done
  sources hmd_bridge | xargs -r grep -HnE '#include "(ingest|align|merge|semantic|planner|agent|cli)/' |
    none 'hmd_bridge includes another process' || failed=1
  sources modules planner hmd_bridge | grep '\.hpp$' | grep -vE '^hmd_bridge/server/(reply|web_socket).hpp' | xargs -r grep -HnE '#include <(pcl|ompl|boost/beast)/' |
    none 'a header that is slow to compile, in a header' || failed=1
  return "$failed"
}

# The top level is fixed (CONTRIBUTING.md): what a program left there once went in unseen.
top_level() {
  git rev-parse --is-inside-work-tree >/dev/null 2>&1 || { echo 'no git checkout'; exit 77; }
  git ls-files | cut -d/ -f1 | sort -u |
    grep -vxE 'CMakeLists\.txt|CMakePresets\.json|lcmtypes|modules|planner|hmd_bridge|tests|logs|run|\.ci|\.clang-(format|tidy)|\.gitignore|(README|CONTRIBUTING|CHANGELOG)\.md|LICENSE' |
    none 'at the top level, and none of what stands there'
}

file_length() {
  { sources modules planner hmd_bridge tests; find run lcmtypes modules tests -name '*.lcm' -o -name '*.sh' -o -name '*.java' -o -name run; } |
    xargs wc -l | awk '$2 != "total" && $1 > ($2 ~ /^tests\// ? 400 : 320) {print "  " $2 ": " $1}' | none 'files that are not read in one sitting'
}

# Every field says what it is, with unit and frame, in // comments on the line before: lcm-gen loses trailing ones.
# A comment may speak for the fields that follow it directly.
message_comments() {
  local file
  for file in lcmtypes/*.lcm; do
    awk -v file="$file" '
      /^[[:space:]]*$/ {commented = 0}
      /^[[:space:]]*\/\// {commented = 1; next}
      /^struct/ {if (!commented) print file ":" FNR ": " $0; commented = 0; next}
      /^package|^[[:space:]]*const/ {next}
      /;/ {if (!commented || /\/\//) print file ":" FNR ": " $0}' "$file"
  done | none 'fields without a comment on the line before'
}

test_waits() {
  sources tests | xargs -r grep -HnE 'sleep_for|sleep_until|usleep\(|[^_a-z]sleep\(' | none 'tests wait for events, they do not sleep'
}

format() {
  local file
  case $(clang-format --version 2>/dev/null) in  # other versions break lines elsewhere
    *'version 14.'*) ;;
    *) echo 'clang-format 14 is not installed'; exit 77 ;;
  esac
  sources modules planner hmd_bridge tests | while read -r file; do
    clang-format --dry-run --Werror "$file" 2>/dev/null || echo "$file"
  done | none 'files that clang-format would change'
}

case ${1:-} in
  dependencies | top_level | file_length | message_comments | test_waits | format) "$1" ;;
  *) echo 'check.sh dependencies | top_level | file_length | message_comments | test_waits | format'; exit 2 ;;
esac
