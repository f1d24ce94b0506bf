#!/usr/bin/env bash
# Run in the tree that the packages were installed into, while the service runs (run_unit.py gives its SERVICE_PID):
#   check_service.sh first    feeds it, asks it in every way
#   check_service.sh again    after a restart: the map is the one of before
set -euo pipefail

readonly FRAMES=100
readonly RATE_HZ=8  # slow machines keep up; what a fast stream takes is shown elsewhere

fail() {
  printf 'FAILED: %s\n' "$*" >&2
  exit 1
}

# Asked until it is so, for a minute.
wait_until() {
  local deadline=$((SECONDS + 60))
  until "$@"; do
    ((SECONDS < deadline)) || fail "not within a minute: $*"
    sleep 0.2
  done
}

# A datagram may be lost where this machine's receive buffers are small, but hardly more.
most_are_mapped() {
  local mapped
  mapped=$(planemap status --json |
    python3 -c 'import json, sys; print(json.load(sys.stdin)["counters"]["scans.mapped"])')
  ((mapped >= FRAMES * 9 / 10))
}

plane_ids() {
  planemap snapshot --json | python3 -c 'import json, sys; print(*sorted(plane["id"] for plane in json.load(sys.stdin)["planes"]))'
}

check_surroundings() {
  [[ $(stat --format %U "/proc/$SERVICE_PID") == planemap ]] || fail 'the service runs as another user'
  [[ -s /var/lib/planemap/map.planemap ]] || fail 'there is no map file in the state directory'
  if touch /usr/planted 2>/dev/null; then fail 'the system could be written to: this run shows nothing'; fi
  python3 - <<'PYTHON' || fail 'HTTP'
import urllib.request

def get(path):
    with urllib.request.urlopen("http://127.0.0.1:7671" + path, timeout=10) as answer:
        return answer.read().decode()

get("/healthz")
get("/readyz")
assert "planemap_scans" in get("/metrics"), "no metrics"
assert "<html" in get("/"), "no page"
PYTHON
}

ask_with_everything() {
  local count=$1 program
  # The clients of the packages tell of as many planes as the command line does.
  [[ $(python3 -c 'import planemap; print(len(planemap.connect().snapshot().planes))') == "$count" ]] || fail 'Python'
  [[ $(planemap snapshot --json --lcm-url default |
    python3 -c 'import json, sys; print(len(json.load(sys.stdin)["planes"]))') == "$count" ]] || fail 'planemap over LCM'
  for program in /consumer/build/over_lcm /consumer/build/over_grpc /consumer/over_lcm /consumer/over_grpc; do
    [[ ! -e /consumer ]] || [[ $("$program") == "$count" ]] || fail "$program"
  done
}

case $1 in
  first)
    planemap-kinect-bridge --simulate apartment --seed 1 --frames "$FRAMES" --rate "$RATE_HZ" --quiet
    wait_until most_are_mapped
    ids=$(plane_ids)
    count=$(wc -w <<<"$ids")
    ((count >= 10)) || fail "only $count planes"
    check_surroundings
    ask_with_everything "$count"
    printf '%s\n' "$ids" >/var/lib/planemap/ids-before
    printf '%d frames in, %d planes out: ' "$FRAMES" "$count"
    planemap snapshot | sed -n 1,4p
    ;;
  again)
    [[ $(plane_ids) == "$(</var/lib/planemap/ids-before)" ]] || fail "the map is another one after the restart: $(plane_ids)"
    echo 'After a restart the map has the same planes.'
    ;;
  *) fail "what is '$1'?" ;;
esac
