#!/usr/bin/env bash
# What every script for users promises: --help on stdout with exit code 0; wrong use is exit code 2 with words on stderr.
set -euo pipefail

failures=0

# expect EXIT_CODE OUTPUT_PATTERN COMMAND...
expect() {
  local code=$1 pattern=$2 output result=0
  shift 2
  output=$("$@" 2>&1 </dev/null) || result=$?
  if ((result != code)) || ! grep --quiet --extended-regexp -- "$pattern" <<<"$output"; then
    printf 'FAILED: %s\n  exit code %d, expected %d, and output like: %s\n%s\n' "$*" "$result" "$code" "$pattern" "$output"
    failures=$((failures + 1))
  fi
}

for script in deploy/install-deps.sh deploy/test.sh deploy/demo.sh deploy/package.sh deploy/test_packages.sh; do
  expect 0 '^Usage: ' "$script" --help
  expect 2 "what is '--nonsense'" "$script" --nonsense
done
expect 2 '--preset takes a value' deploy/test.sh --preset
expect 2 '--out takes a value' deploy/package.sh --out
expect 2 '--tree takes a value' deploy/test_packages.sh --tree
expect 2 '--seconds takes a value' deploy/demo.sh --seconds
expect 2 "a number of seconds.*'soon'" deploy/demo.sh --seconds soon
expect 0 '^libeigen3-dev$' deploy/install-deps.sh --list build
expect 0 '^lcm-?|^liblcm1$' deploy/install-deps.sh --list run
expect 0 '^help2man$' deploy/install-deps.sh --list package

((failures == 0)) || exit 1
echo 'All as promised.'
