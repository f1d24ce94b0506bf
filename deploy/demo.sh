#!/usr/bin/env bash
# Shows a plane map growing: planemapd and a simulated Kinect, joined by LCM multicast as they would be on a robot.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
. "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

readonly GROUP='239.255.76.67'  # LCM's own multicast group
readonly PORT=7667
readonly RATE_HZ=15
readonly HOST_ADDRESS='169.254.76.1/30'  # the two ends of the veth pair; link-local, so nobody's network is hidden
readonly DEMO_ADDRESS='169.254.76.2/30'

usage() {
  cat <<'USAGE'
Usage: demo.sh [--seconds N] [--namespace|--host] [--out DIR] [--seed N] [--bin DIR] [--no-install]

Installs and builds what it runs, starts planemapd and a simulated Kinect that drives through an apartment, shows the map
growing, and after a minute prints the table of planes and writes the floor plan (SVG), the cells (PLY) and the planes (JSON).

  --seconds N     how long the Kinect drives (default 60)
  --seed N        another apartment (default 1)
  --out DIR       where the results go (default build/demo)
  --host          use the machine's own multicast; nothing leaves the machine (ttl 0)
  --namespace     use a network namespace of the demo's own. As root it is joined to the machine by a veth pair.
                  Without either: the machine's multicast if there is a route for it, else a namespace.
  --bin DIR       run the executables of DIR instead of building them
  --no-install    take the packages as they are
  -h, --help      this text

Exit codes: 0 done, 1 failed, 2 wrong use.
USAGE
}

# --- what the user chose ------------------------------------------------------------------------------------------------
seconds=60
seed=1
network=auto  # auto, host, namespace; inside: we are in the namespace
out_dir=''
bin_dir=''
install=1

parse_arguments() {
  while (($#)); do
    case $1 in
      -h | --help) usage; exit 0 ;;
      --seconds) need_value "$1" $#; seconds=$2; shift ;;
      --seed) need_value "$1" $#; seed=$2; shift ;;
      --out) need_value "$1" $#; out_dir=$2; shift ;;
      --bin) need_value "$1" $#; bin_dir=$2; shift ;;
      --host) network=host ;;
      --namespace) network=namespace ;;
      --inside-namespace) network=inside ;;  # the script calls itself with it
      --no-install) install=0 ;;
      *) usage >&2; die "what is '$1'?" 2 ;;
    esac
    shift
  done
  [[ $seconds =~ ^[1-9][0-9]{0,4}$ ]] || die "--seconds takes a number of seconds from 1 to 99999, not '$seconds'" 2
  [[ $seed =~ ^[0-9]{1,9}$ ]] || die "--seed takes a whole number, not '$seed'" 2
}

# --- network ------------------------------------------------------------------------------------------------------------
has_multicast_route() {
  local route device
  route=$(ip route get "$GROUP" 2>/dev/null) || return 1
  device=$(sed -n 's/.* dev \([^ ]*\).*/\1/p;q' <<<"$route")
  ip link show dev "$device" 2>/dev/null | grep --quiet -w MULTICAST
}

# Ends this process and goes on as `demo.sh --inside-namespace` in a network namespace of its own. The kernel removes the
# namespace, the veth pair and its route with the last process in it, however the demo ends.
enter_namespace() {
  local unshare=(unshare --net)
  ((EUID == 0)) || unshare=(unshare --net --map-root-user)
  "${unshare[@]}" true 2>/dev/null ||
    die "cannot make a network namespace here (unshare --net). Run as root, or give this machine a multicast route:
  sudo ip link set lo multicast on && sudo ip route add 224.0.0.0/4 dev lo    and use --host"
  exec 9</proc/self/ns/net  # the machine's network, for the veth pair
  PLANEMAP_DEMO_USER=$EUID exec "${unshare[@]}" -- bash "${BASH_SOURCE[0]}" --inside-namespace --no-install \
    --seconds "$seconds" --seed "$seed" --out "$out_dir" --bin "$bin_dir"
}

# Gives the fresh namespace a multicast route; as root through a veth pair, so that the machine's tools reach the daemon.
set_up_namespace() {
  ip link set lo up
  if [[ ${PLANEMAP_DEMO_USER:-0} == 0 ]] && join_to_host; then
    ip route add 224.0.0.0/4 dev planemap1
    lcm_url="udpm://$GROUP:$PORT?ttl=1"  # one hop: over the veth pair and no farther
    joined="planemap status --lcm-url '$lcm_url'"
  else
    ip link set lo multicast on
    ip route add 224.0.0.0/4 dev lo
    joined="nsenter --target $$ --user --preserve-credentials --net planemap status"
    ((${PLANEMAP_DEMO_USER:-0})) || joined="nsenter --target $$ --net planemap status"
  fi
}

join_to_host() {
  local on_host=(nsenter --net=/proc/self/fd/9)
  ip link add planemap1 type veth peer name planemap0 2>/dev/null &&
    ip link set planemap0 netns /proc/self/fd/9 2>/dev/null ||
    return 1
  ip address add "$DEMO_ADDRESS" dev planemap1
  ip link set planemap1 up
  "${on_host[@]}" ip address add "$HOST_ADDRESS" dev planemap0
  "${on_host[@]}" ip link set planemap0 up
  # Only where the machine has no route to the group: its own multicast stays as it is.
  "${on_host[@]}" ip route get "$GROUP" >/dev/null 2>&1 || "${on_host[@]}" ip route add "$GROUP/32" dev planemap0
}

# --- processes ----------------------------------------------------------------------------------------------------------
lcm_url="udpm://$GROUP:$PORT?ttl=0"
joined=''
daemon_pid=''
kinect_pid=''

stop_process() {
  local pid=$1
  [[ -n $pid ]] && kill -TERM "$pid" 2>/dev/null || return 0
  for _ in {1..50}; do
    kill -0 "$pid" 2>/dev/null || break
    sleep 0.1
  done
  kill -KILL "$pid" 2>/dev/null || true
  wait "$pid" 2>/dev/null || true
}

# However the demo ends, nothing of it stays behind.
clean_up() {
  local result=$?
  trap - EXIT INT TERM
  [[ -t 1 ]] && printf '\033[?25h'
  stop_process "$kinect_pid"
  stop_process "$daemon_pid"
  if ((result != 0)) && [[ -s ${daemon_log:-} ]]; then
    printf '\nThe demo did not end well (%d). The last the daemon said (all of it: %s):\n' "$result" "$daemon_log" >&2
    tail -n 10 "$daemon_log" >&2
    [[ ! -s ${kinect_log:-} ]] || { printf 'The simulated Kinect said:\n' >&2; tail -n 5 "$kinect_log" >&2; }
  fi
  exit "$result"
}

planemap_status() {
  "$bin_dir/planemap" status --json --lcm-url "$lcm_url" --timeout 1 2>/dev/null
}

start_daemon() {
  if planemap_status >/dev/null; then
    die "a planemapd answers already on $lcm_url; stop it, or use --namespace"
  fi
  "$bin_dir/planemapd" --config "$project/deploy/planemapd.yaml" --set 'map.gravity=[0, 0, -1]' --lcm-url "$lcm_url" \
    9<&- >"$daemon_log" 2>&1 </dev/null &
  daemon_pid=$!
  for _ in {1..20}; do
    planemap_status >/dev/null && return
    kill -0 "$daemon_pid" 2>/dev/null || die "planemapd ended right away; its log is $daemon_log"
  done
  die "planemapd runs but does not answer; its log is $daemon_log"
}

start_kinect() {
  "$bin_dir/planemap-kinect-bridge" --simulate apartment --seed "$seed" --frames $((seconds * RATE_HZ)) --rate "$RATE_HZ" \
    --truth "$out_dir/truth.json" --lcm-url "$lcm_url" --quiet 9<&- >"$kinect_log" 2>&1 </dev/null &
  kinect_pid=$!
}

# --- what the user sees -------------------------------------------------------------------------------------------------
status_line() {
  jq --raw-output '"planes \(.planeCount), cells \(.cellCount), \(.scanRateHz * 10 | round / 10) scans/s, " +
    "mapped \(.counters["scans.mapped"] // 0), " +
    "dropped \([.counters | to_entries[] | select(.key | startswith("scans.dropped")) | .value] | add // 0)" +
    (if .idleReason == "" then "" else "  [\(.idleReason)]" end)'
}

# One line that is updated on a terminal, else a line every 5 s.
show_progress() {
  local started=$SECONDS now status next_line=0
  [[ -t 1 ]] && printf '\033[?25l'
  while kill -0 "$kinect_pid" 2>/dev/null && ((SECONDS - started < seconds + 5)); do
    now=$((SECONDS - started))
    status=$(planemap_status | status_line) || status='(no answer)'
    kill -0 "$daemon_pid" 2>/dev/null || die "planemapd ended; its log is $daemon_log"
    if [[ -t 1 ]]; then
      printf '\r\033[K%3d s  %.*s' "$now" "$((${COLUMNS:-$(tput cols 2>/dev/null || echo 100)} - 8))" "$status"
    elif ((now >= next_line)); then
      printf '%3d s  %s\n' "$now" "$status"
      next_line=$((now + 5))
    fi
    sleep 1 &
    wait $! || true
  done
  [[ -t 1 ]] && printf '\r\033[K'
  printf '%3d s  %s\n' "$((SECONDS - started))" "$(planemap_status | status_line)"
}

finish_kinect() {
  local result=0
  if kill -0 "$kinect_pid" 2>/dev/null; then
    stop_process "$kinect_pid"
  else
    wait "$kinect_pid" || result=$?
    ((result == 0)) || die "the simulated Kinect failed; its log is $kinect_log"
  fi
  kinect_pid=''
}

finish_daemon() {
  local result=0
  kill -TERM "$daemon_pid"
  wait "$daemon_pid" || result=$?
  daemon_pid=''
  ((result == 0)) || die "planemapd did not end cleanly ($result); its log is $daemon_log"
}

write_results() {
  "$bin_dir/planemap" export - "$out_dir/floorplan.svg" "$out_dir/cells.ply" "$out_dir/planes.json" \
    --lcm-url "$lcm_url" >>"$out_dir/export.log" 2>&1 || die "planemap export failed: $(tail -n 3 "$out_dir/export.log")"
  say "Planes"
  "$bin_dir/planemap" snapshot --lcm-url "$lcm_url"
}

run_demo() {
  daemon_log="$out_dir/planemapd.log"
  kinect_log="$out_dir/kinect.log"
  trap clean_up EXIT
  trap 'exit 130' INT
  trap 'exit 143' TERM
  start_daemon
  start_kinect
  say "The Kinect drives through the apartment for $seconds s (seed $seed, $RATE_HZ scans/s, LCM $lcm_url)"
  [[ -z $joined ]] || printf 'To look at it from another terminal: %s\n' "$joined"
  show_progress
  finish_kinect
  write_results
  finish_daemon
  say "Results"
  printf '%-12s %s\n' 'floor plan' "$out_dir/floorplan.svg" 'cells' "$out_dir/cells.ply" \
    'planes' "$out_dir/planes.json" 'the truth' "$out_dir/truth.json" 'daemon log' "$daemon_log"
}

build() {
  local first_time=()
  cd "$project"
  # Without the tests, whose packages need not be here; a build folder that has them keeps them.
  [[ -f build/release/CMakeCache.txt ]] || first_time=(-DPLANEMAP_BUILD_TESTS=OFF)
  say "Building (a few minutes the first time)"
  cmake --preset release "${first_time[@]}"
  cmake --build --preset release --parallel "$(build_jobs)" --target planemapd planemap-kinect-bridge planemap
}

main() {
  parse_arguments "$@"
  project=$(project_dir)
  if ((install)); then "$project/deploy/install-deps.sh" run build; fi
  if [[ -z $bin_dir ]]; then
    build
    bin_dir="$project/build/release/bin"
  fi
  mkdir -p "${out_dir:=$project/build/demo}"
  out_dir=$(cd "$out_dir" && pwd)
  bin_dir=$(cd "$bin_dir" && pwd)

  if [[ $network == auto ]]; then
    if has_multicast_route; then network=host; else network=namespace; fi
  fi
  case $network in
    host) has_multicast_route || die "this machine has no multicast route; leave out --host, or add one:
  sudo ip link set lo multicast on && sudo ip route add 224.0.0.0/4 dev lo" ;;
    namespace) enter_namespace ;;
    inside) set_up_namespace ;;
  esac
  run_demo
}

main "$@"
