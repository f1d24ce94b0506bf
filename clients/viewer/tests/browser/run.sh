#!/usr/bin/env bash
# The page in a real browser on a real planemapd with real multicast, all in a network namespace of its own, which has no way out:
# tests/browser/run.sh [BIN_DIR] [arguments of vitest]. Pictures go to PLANEMAP_ARTEFACTS, or to test-results/.
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.."

if [[ ${1:-} != --inside ]]; then
  bin_dir=${1:-../../build/dev/bin}
  shift || true
  PLANEMAP_BIN_DIR=$(cd -- "$bin_dir" && pwd)
  export PLANEMAP_BIN_DIR
  unshare=(unshare --net)
  ((EUID == 0)) || unshare=(unshare --net --map-root-user)
  exec "${unshare[@]}" -- bash tests/browser/run.sh --inside "$@"
fi
shift
ip link set lo up
ip link set lo multicast on
ip route add 224.0.0.0/4 dev lo
exec node_modules/.bin/vitest run --config vitest.browser.config.ts "$@"
