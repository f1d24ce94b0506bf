#!/usr/bin/env bash
# What the completion for bash offers, asked as bash asks it: completion_test.sh BIN_DIR
set -uo pipefail
PATH=$(cd -- "$1" && pwd):$PATH
# shellcheck source=/dev/null
. /usr/share/bash-completion/bash_completion
# shellcheck source=/dev/null
. "$(dirname -- "${BASH_SOURCE[0]}")/../../deploy/completion/planemap.bash"
failures=0
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
touch settings.yaml
mkdir room

# offers "OFFER OFFER..." WORD...: what the last word, which is not finished, may become. A leading + : these among others.
offers() {
  local expected=$1 offered wanted
  shift
  COMP_WORDS=("$@")
  COMP_CWORD=$(($# - 1))
  COMP_LINE="$*"
  COMP_POINT=${#COMP_LINE}
  COMPREPLY=()
  _planemap "$1" "${!#}" "${COMP_WORDS[COMP_CWORD - 1]}" 2>/dev/null
  offered=" $(printf '%s\n' "${COMPREPLY[@]}" | sort | paste --serial --delimiters=' ') "
  if [[ $expected == +* ]]; then
    for wanted in ${expected#+}; do
      [[ $offered == *" $wanted "* ]] || fail "$wanted" "$offered" "$*"
    done
  elif [[ $offered != " $expected " ]]; then
    fail "$expected" "$offered" "$*"
  fi
}

fail() {
  printf "FAILED: '%s' offers '%s', expected '%s'\n" "$3" "$2" "$1"
  failures=$((failures + 1))
}

offers 'snapshot' planemap sn
offers '+build status export nearest watch' planemap ''
offers '--help --version' planemap --
offers '--export' planemap build --exp
offers 'best paper' planemap build --preset ''
offers 'settings.yaml' planemap build --config s
offers '+room' planemap build r
offers '' planemap build --frames ''
offers '+floor ceiling wall' planemap nearest --class ''
offers '+floor ceiling wall' planemap region --json --class ''
offers 'settings.yaml' planemapd --config se
offers 'settings.yaml' planemapd -c se
offers 'best paper' planemapd --preset ''
offers '+--config --set --print-config' planemapd --
offers 'rigid_transform' planemap-kinect-bridge --pose-format ri
offers 'room' planemap-kinect-bridge --dataset ''
offers '--timeout --tls --token-file' planemap nearest --t

# All that --help lists is offered.
for command in planemapd planemap-kinect-bridge 'planemap build' 'planemap region' 'planemap export'; do
  # shellcheck disable=SC2086
  options=$($command --help | sed --quiet --regexp-extended 's/^ +(-[a-zA-Z],)?(--[a-z-]+)( .*|$)/\2/p')
  [[ $(wc -w <<<"$options") -ge 3 ]] || fail 'at least 3 options' "$options" "$command --help"
  # shellcheck disable=SC2086
  offers "+${options//$'\n'/ }" $command --
done

((failures == 0)) || exit 1
echo 'All as promised.'
