#!/usr/bin/env bash
# Fails where a tracked file names a place that exists on one machine only: a home or build folder, a package registry. What
# is cloned must build anywhere. The patterns are written so that they don't match themselves.
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."

readonly PATTERNS=(
  '(^|[^[:alnum:]_./-])/(work|home|root|Users|mnt)/[[:alnum:]_.-]'  # folders of a machine or a person
  '(^|[^[:alnum:]_./-])/tmp/[b]uild'                               # build folders outside of build/
  '[r]egistry\.(npmjs|yarnpkg)\.'
  '([p]ypi|[p]ythonhosted)\.org'
  '[.]pkg\.dev/|[a]rtifactory|[n]exus[.-]'
  '([p]roxy\.golang|[c]rates)\.(org|io)'
  '[d]eb\.debian\.org|[s]napshot\.debian\.org'
)

result=0
for pattern in "${PATTERNS[@]}"; do
  if git grep --line-number --extended-regexp -I -e "$pattern" -- . ':!.ci/check_words.sh'; then
    printf 'The lines above name a place that other machines do not have (pattern: %s).\n' "$pattern" >&2
    result=1
  fi
done
exit "$result"
