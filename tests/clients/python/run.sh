#!/usr/bin/env bash
# Runs the tests of the Python package in a network namespace of their own, where multicast goes by the loopback:
# run.sh BIN_DIR PACKAGE_DIR [ARGUMENT FOR PYTEST]... Ends with 77 where namespaces are not permitted.
set -euo pipefail
export PLANEMAP_BIN_DIR=${1:?} PYTHONPATH=${2:?} PYTHONDONTWRITEBYTECODE=1
shift
shift
readonly namespace=(unshare --map-root-user --net)
"${namespace[@]}" true 2>/dev/null || {
  echo 'skipped: network namespaces are not permitted here'
  exit 77
}
# shellcheck disable=SC2016  # the inner shell's
exec "${namespace[@]}" bash -c 'ip link set lo up && ip route add 224.0.0.0/4 dev lo && exec "$@"' run \
  /usr/bin/python3 -m pytest -q -p no:cacheprovider "$@" "$(dirname -- "${BASH_SOURCE[0]}")"
