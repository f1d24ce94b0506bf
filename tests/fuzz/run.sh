#!/usr/bin/env bash
# Builds the fuzz targets with clang and runs each of them for a while, beginning with the kept corpus.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=../../deploy/common.sh
. "$(dirname -- "${BASH_SOURCE[0]}")/../../deploy/common.sh"

usage() {
  cat <<'USAGE'
Usage: run.sh [--seconds N] [--jobs N] [--keep] [TARGET]...

Builds the fuzz targets (preset fuzz: clang, libFuzzer, address and undefined behaviour sanitizers) and runs each for a while,
beginning with what is in tests/fuzz/corpus. Prints executions a second of each.

  --seconds N   how long each target runs (default 60)
  --jobs N      how many run at once (default: one a core)
  --keep        put new inputs that reach new code into the corpus: the smallest set that reaches it all
  TARGET        run only these (default: all in tests/fuzz/targets)
  -h, --help    this text

A finding is kept in build/fuzz/findings and named. Run it again with build/fuzz/bin/fuzz_TARGET FILE.
Exit codes: 0 nothing was found, 1 something was found or failed, 2 wrong use.
USAGE
}

# Runs one target; its output goes into a log, a line of it here.
fuzz() {
  local name=$1 seconds=$2 work=build/fuzz/work/$1 log=build/fuzz/$1.log result=0
  mkdir -p "$work" build/fuzz/findings
  # A second for one input is far too long; a gigabyte far too much.
  "build/fuzz/bin/fuzz_$name" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=1024 -max_len=65536 -use_value_profile=1 \
    -print_final_stats=1 -artifact_prefix="build/fuzz/findings/$name-" "$work" "tests/fuzz/corpus/$name" >"$log" 2>&1 || result=$?
  local runs per_s
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  per_s=$(sed -n 's/^stat::average_exec_per_sec: *//p' "$log")
  if ((result != 0)); then
    printf '%-18s FINDING, see %s\n' "$name" "$log"
    grep -E 'FINDING|ERROR: |runtime error|SUMMARY|Test unit written' "$log" | head -n 8
    return 1
  fi
  printf '%-18s %10s runs, %7s a second, nothing found\n' "$name" "$runs" "$per_s"
}

keep() {
  local name=$1
  mkdir -p "build/fuzz/merged/$name"
  rm -f "build/fuzz/merged/$name"/*
  "build/fuzz/bin/fuzz_$name" -merge=1 -max_len=65536 "build/fuzz/merged/$name" "tests/fuzz/corpus/$name" "build/fuzz/work/$name" \
    >"build/fuzz/$name.merge.log" 2>&1
  rm -f "tests/fuzz/corpus/$name"/*
  cp "build/fuzz/merged/$name"/* "tests/fuzz/corpus/$name/"
}

main() {
  local seconds=60 jobs keeping=0 names=()
  jobs=$(nproc)
  while (($#)); do
    case $1 in
      -h | --help) usage; exit 0 ;;
      --seconds) need_value "$1" $#; seconds=$2; shift ;;
      --jobs) need_value "$1" $#; jobs=$2; shift ;;
      --keep) keeping=1 ;;
      -*) usage >&2; die "what is '$1'?" 2 ;;
      *) names+=("$1") ;;
    esac
    shift
  done
  cd "$(project_dir)"
  if ((${#names[@]} == 0)); then
    mapfile -t names < <(basename -s .cpp tests/fuzz/targets/*.cpp)
  fi
  local name
  for name in "${names[@]}"; do
    [[ -f tests/fuzz/targets/$name.cpp ]] || die "there is no target '$name' in tests/fuzz/targets" 2
  done
  say "Building (preset fuzz)"
  cmake --preset fuzz >/dev/null
  cmake --build --preset fuzz --parallel "$(build_jobs)"

  say "Fuzzing: ${#names[@]} targets, $seconds s each, $jobs at once"
  export -f fuzz
  local result=0
  printf '%s\n' "${names[@]}" | xargs -P "$jobs" -I{} bash -c "fuzz {} $seconds" || result=1
  if ((keeping)); then
    say "Keeping the smallest corpus that reaches the same"
    for name in "${names[@]}"; do keep "$name"; done
    du -sh tests/fuzz/corpus
  fi
  return "$result"
}

main "$@"
