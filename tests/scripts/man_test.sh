#!/usr/bin/env bash
# The manual pages say what --help says: a page for each program and command, with each of its options, that man reads without
# a warning: man_test.sh BIN_DIR
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.."
bin_dir=$(cd -- "$1" && pwd)
PATH=$bin_dir:$PATH
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

fail() {
  printf 'FAILED: %s\n' "$*"
  failures=$((failures + 1))
}

# check_page NAME COMMAND...
check_page() {
  local name=$1 page=$work/$1.1.gz text warnings option options
  shift
  [[ -s $page ]] || { fail "no page $name"; return 0; }
  warnings=$(MANWIDTH=200 man --warnings=all --encoding=UTF-8 --local-file "$page" 2>&1 >"$work/text") || fail "man cannot read $name"
  [[ -z $warnings ]] || fail "$name: $warnings"
  text=$(col -b <"$work/text")
  grep --quiet "^ *$name - ." <<<"$text" || fail "$name: its NAME is $(grep -A1 '^NAME' <<<"$text" | tail -n 1)"
  options=$("$@" --help | grep --only-matching --extended-regexp '^ +(-[a-zA-Z],)?--[a-z-]+' | sed 's/.*--/--/')
  [[ -n $options ]] || fail "$* has no options"
  for option in $options; do
    grep --quiet -- "$option" <<<"$text" || fail "$name does not tell of $option"
  done
}

deploy/man/make_pages.sh "$bin_dir" "$work"
check_page planemapd planemapd
check_page planemap-kinect-bridge planemap-kinect-bridge
check_page planemap planemap
commands=$(planemap --help | sed --quiet '/^Subcommands:/,/^$/ s/^  \([a-z-]*\) .*/\1/p')
(($(wc -w <<<"$commands") >= 10)) || fail "planemap lists the commands '$commands'"
for command in $commands; do
  check_page "planemap-$command" planemap "$command"
done

((failures == 0)) || exit 1
echo 'All as promised.'
