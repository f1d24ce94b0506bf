#!/usr/bin/env bash
# Installs what the tests need, builds, runs them through CTest and says how it went.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
. "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

usage() {
  cat <<'USAGE'
Usage: test.sh [--no-install] [--preset NAME] [--only TESTS]... [-- CTEST_ARGUMENT...]

Installs the packages, builds planemap with its tests and runs all of them through CTest.

  --preset NAME   CMake preset: release (default), dev (asserts, warnings are errors), asan, tsan
  --only TESTS    build and run only the tests of a folder of tests/ (core, service, clients, system, ...), or one program of
                  it (service/mapping_test); may be repeated
  --no-install    take the packages as they are
  -h, --help      this text
  -- ARGUMENT...  handed to ctest, for instance: -- -R Plane

Tests on real recordings run where PLANEMAP_TEST_DATA names the folder that holds them, and are skipped elsewhere.
Exit codes: 0 all passed, 1 something failed, 2 wrong use.
USAGE
}

# Says how many passed, failed and were skipped, from CTest's JUnit file.
summary() {
  local junit=$1 started=$2 tests failed skipped
  tests=$(sed -n '/<testsuite /,/>/ s/.*[[:space:]]tests="\([0-9]*\)".*/\1/p' "$junit" | head -n 1)
  failed=$(sed -n '/<testsuite /,/>/ s/.*[[:space:]]failures="\([0-9]*\)".*/\1/p' "$junit" | head -n 1)
  skipped=$(sed -n '/<testsuite /,/>/ s/.*[[:space:]]skipped="\([0-9]*\)".*/\1/p' "$junit" | head -n 1)
  say "$tests tests: $((tests - failed - skipped)) passed, $failed failed, $skipped skipped; $(elapsed_since "$started") in all"
  if [[ -z ${PLANEMAP_TEST_DATA:-} ]]; then
    echo "PLANEMAP_TEST_DATA is not set: the tests on real recordings were skipped."
  fi
}

main() {
  local preset=release install=1 only=() targets=() started label_pattern jobs
  while (($#)); do
    case $1 in
      -h | --help) usage; exit 0 ;;
      --no-install) install=0 ;;
      --preset) need_value "$1" $#; preset=$2; shift ;;
      --only) need_value "$1" $#; only+=("$2"); shift ;;
      --) shift; break ;;
      *) usage >&2; die "what is '$1'?" 2 ;;
    esac
    shift
  done
  started=$(date +%s)
  cd "$(project_dir)"
  ((install == 0)) || deploy/install-deps.sh run build test

  jobs=$(build_jobs)
  say "Building (preset $preset, $jobs jobs)"
  cmake --preset "$preset" -DPLANEMAP_BUILD_TESTS=ON
  local filter=()
  if ((${#only[@]})); then
    mapfile -t targets < <(printf '%s\n' "${only[@]}" | sed 's#^[^/]*$#tests_&#; s#.*/##')
    targets=(--target "${targets[@]}")
    label_pattern=$(IFS='|'; echo "${only[*]}")
    filter=(--label-regex "^($label_pattern)(/|\$)")
  fi
  cmake --build --preset "$preset" --parallel "$jobs" "${targets[@]}"

  say "Testing"
  local junit="$PWD/build/$preset/tests.xml" result=0
  rm -f "$junit"
  ctest --preset "$preset" --parallel "$jobs" --output-junit "$junit" "${filter[@]}" "$@" || result=1
  [[ -s $junit ]] || die "ctest ran no test"
  summary "$junit" "$started"
  exit "$result"
}

main "$@"
