#!/usr/bin/env bash
# What systemd says of the unit: unit_test.sh PLANEMAPD
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.."
readonly MOST_EXPOSURE=20  # of 100, as systemd counts it; what is left is the network

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# It asks for the program and the page: those of the build stand for the installed ones.
sed "s#^ExecStart=[^ ]*#ExecStart=$1#; /^Documentation=/d" deploy/systemd/planemapd.service >"$work/planemapd.service"
complaints=$(systemd-analyze verify --man=no "$work/planemapd.service" 2>&1 | grep planemapd) || true
[[ -z $complaints ]] || { printf 'FAILED: %s\n' "$complaints"; exit 1; }
systemd-analyze security --no-pager --offline=true --threshold="$MOST_EXPOSURE" "$work/planemapd.service" >"$work/security" || {
  grep --invert-match '^✓' "$work/security"
  exit 1
}
tail -n 1 "$work/security"
