#!/usr/bin/env bash
# Installs the packages into a Debian 12 of their own, runs the service there and asks it for planes.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
. "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

usage() {
  cat <<'USAGE'
Usage: test_packages.sh [--packages DIR] [--no-compiler] [--tree DIR]

Makes a minimal Debian 12 with debootstrap, in a temporary folder, installs the packages there with apt as a user would, and
  - lets lintian look at the packages, where it is there
  - runs the service as its systemd unit says, as its own user, with all but its state directory read-only, and in a network
    namespace of its own
  - feeds it with planemap-kinect-bridge's simulation, and asks for planes with planemap, Python and C++ programs, which are
    built there with the client library by CMake and by pkg-config
  - starts it again: the map must be the one of before
  - looks at manual pages, completion and the settings, and purges the packages
Needs root, and the network for apt, whose sources and proxies are those of this machine. The packages are those of
deploy/package.sh.

  --packages DIR  where they are (default build/packages)
  --no-compiler   don't install a compiler and build programs there
  --tree DIR      make the tree there and leave it; it must not exist
  -h, --help      this text

Exit codes: 0 all passed, 1 something failed, 2 wrong use.
USAGE
}

# --- what the user chose ------------------------------------------------------------------------------------------------
packages=''
tree=''
compiler=1
inside=0

parse_arguments() {
  while (($#)); do
    case $1 in
      -h | --help) usage; exit 0 ;;
      --packages) need_value "$1" $#; packages=$2; shift ;;
      --tree) need_value "$1" $#; tree=$2; shift ;;
      --no-compiler) compiler=0 ;;
      --inside-namespace) inside=1 ;;  # the script calls itself with it
      *) usage >&2; die "what is '$1'?" 2 ;;
    esac
    shift
  done
}

# --- the packages themselves --------------------------------------------------------------------------------------------
# Whoever uploads them to Debian gives them a maintainer (PLANEMAP_PACKAGE_CONTACT) and closes a bug with it.
readonly LINTIAN_EXCEPT=bogus-mail-host,bogus-mail-host-in-debian-changelog,initial-upload-closes-no-bugs

run_lintian() {
  if ! command -v lintian >/dev/null; then
    say 'lintian is missing: not asked (deploy/install-deps.sh test)'
    return
  fi
  say 'What lintian says'
  lintian --allow-root --fail-on error,warning --suppress-tags "$LINTIAN_EXCEPT" "$packages"/*.deb || die 'lintian complains'
  echo 'Nothing.'
}

# --- the tree -----------------------------------------------------------------------------------------------------------
# Sets the variable named $1 to the value of apt's setting $2; empty where it is not set.
apt_setting() {
  local "$1"= && eval "$(apt-config shell "$1" "$2")" && printf '%s' "${!1}"
}

make_tree() {
  local mirror
  # shellcheck disable=SC2016  # $(REPO_URI) is apt's
  mirror=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Codename: bookworm' 'Component: main' |
    grep --max-count=1 --invert-match security) || die 'the sources of apt do not name Debian 12 (bookworm, main)'
  http_proxy=$(apt_setting http_proxy Acquire::http::Proxy)
  https_proxy=$(apt_setting https_proxy Acquire::https::Proxy)
  export http_proxy https_proxy
  [[ -n $http_proxy ]] || unset http_proxy
  [[ -n $https_proxy ]] || unset https_proxy
  quietly debootstrap --variant=minbase bookworm "$tree" "$mirror"
  mount -t proc proc "$tree/proc"

  # apt finds there what it finds here, of Debian.
  rm -f "$tree/etc/apt/sources.list"
  cp --archive /etc/apt/sources.list "$tree/etc/apt/" 2>/dev/null || true
  find /etc/apt/sources.list.d -name 'debian*' -exec cp --archive --target-directory="$tree/etc/apt/sources.list.d" {} +
  apt-config dump | grep --extended-regexp '^Acquire::(http|https|Retries)' >"$tree/etc/apt/apt.conf.d/99host" || true
  printf 'APT::Install-Recommends "false";\n' >>"$tree/etc/apt/apt.conf.d/99host"
  cp --dereference /etc/resolv.conf "$tree/etc/resolv.conf"
}

# Runs a command; what it said is shown if it fails.
quietly() {
  local log
  log=$(mktemp)
  if ! "$@" >"$log" 2>&1 </dev/null; then
    tail -n 30 "$log" >&2
    rm -f "$log"
    die "failed: $*"
  fi
  rm -f "$log"
}

in_tree() {
  chroot "$tree" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 HOME=/root DEBIAN_FRONTEND=noninteractive "$@"
}

install_packages() {
  mkdir "$tree/packages"
  cp "$packages"/*.deb "$tree/packages/"
  quietly in_tree apt-get update
  # shellcheck disable=SC2046
  quietly in_tree apt-get install --yes $(cd "$tree" && printf './%s ' packages/{planemapd,planemap-tools,python3-planemap}_*.deb)
}

build_consumers() {
  # shellcheck disable=SC2046
  quietly in_tree apt-get install --yes g++ cmake make pkgconf $(cd "$tree" && printf './%s ' packages/libplanemap-dev_*.deb)
  cp --recursive tests/packages/consumer "$tree/consumer"
  quietly in_tree cmake -S /consumer -B /consumer/build -DCMAKE_BUILD_TYPE=Release
  quietly in_tree cmake --build /consumer/build
  # shellcheck disable=SC2016  # for the shell in the tree
  quietly in_tree sh -ec 'cd /consumer
    g++ -std=c++20 over_lcm.cpp -o over_lcm $(pkgconf --cflags --libs planemap-client)
    g++ -std=c++20 over_grpc.cpp -o over_grpc $(pkgconf --cflags --libs planemap-client-grpc)'
}

# --- the service --------------------------------------------------------------------------------------------------------
# The unit says ProtectSystem=strict and PrivateTmp=yes: so it is here.
protect_tree() {
  mount --bind "$tree" "$tree"
  mount --bind "$tree/var/lib/planemap" "$tree/var/lib/planemap"
  mount -t proc proc "$tree/proc"
  mount -t tmpfs tmpfs "$tree/tmp"
  mount --options remount,bind,ro "$tree"
}

run_service() {
  in_tree /checks/run_unit.py /lib/systemd/system/planemapd.service /checks/check_service.sh "$1"
}

test_service() {
  ip link set lo up
  ip link set lo multicast on
  ip route add 224.0.0.0/4 dev lo
  protect_tree
  run_service first
  run_service again
}

# --- the rest -----------------------------------------------------------------------------------------------------------
check_files() {
  local page
  for page in planemapd planemap planemap-build planemap-kinect-bridge; do
    [[ -s $tree/usr/share/man/man1/$page.1.gz ]] || die "there is no manual page $page"
  done
  [[ -s $tree/usr/share/bash-completion/completions/planemap ]] || die 'there is no completion'
  [[ -L $tree/etc/systemd/system/multi-user.target.wants/planemapd.service ]] || die 'the service is not enabled'
  in_tree planemapd --config /etc/planemap/planemapd.yaml --print-config | grep --quiet '/var/lib/planemap/map.planemap' ||
    die 'the settings do not name the map'
  in_tree dpkg --verify planemapd planemap-tools python3-planemap >"$tree/verified"
  # minbase keeps all files: none may be missing or changed
  [[ ! -s $tree/verified ]] || die "files differ from what was packed: $(<"$tree/verified")"
}

# A user's settings outlive an upgrade and a removal, and nothing outlives a purge.
check_life_of_settings() {
  echo '# mine' >>"$tree/etc/planemap/planemapd.yaml"
  # shellcheck disable=SC2046
  quietly in_tree apt-get install --yes --reinstall $(cd "$tree" && printf './%s ' packages/planemapd_*.deb)
  grep --quiet '^# mine$' "$tree/etc/planemap/planemapd.yaml" || die 'an upgrade overwrote the settings'
  quietly in_tree apt-get remove --yes planemapd
  [[ -e $tree/etc/planemap/planemapd.yaml && -e $tree/var/lib/planemap/map.planemap ]] || die 'a removal took the settings or the map'
  quietly in_tree apt-get purge --yes planemapd planemap-tools python3-planemap
  local left
  left=$(find "$tree/etc" "$tree/usr" "$tree/lib/systemd" "$tree/var/lib/planemap" -path '*planemap*' 2>/dev/null |
    grep --invert-match libplanemap) || true
  ((compiler)) || [[ -z $left ]] || die "a purge left: $left"
  [[ ! -e $tree/etc/planemap && ! -e $tree/var/lib/planemap ]] || die "a purge left: $left"
}

# --- from start to end --------------------------------------------------------------------------------------------------
run_inside() {
  local started
  started=$(date +%s)
  say "A Debian 12 in $tree"
  make_tree
  elapsed_since "$started"; echo

  started=$(date +%s)
  say 'Installing planemapd, planemap-tools and python3-planemap'
  install_packages
  check_files
  elapsed_since "$started"; echo

  if ((compiler)); then
    started=$(date +%s)
    say 'Building programs with libplanemap-dev'
    build_consumers
    elapsed_since "$started"; echo
  fi

  started=$(date +%s)
  say 'Running the service'
  mkdir "$tree/checks"
  cp tests/packages/{run_unit.py,check_service.sh} "$tree/checks/"
  export -f run_service test_service protect_tree in_tree
  export tree
  unshare --net --mount --pid --fork --kill-child -- bash -euo pipefail -c test_service
  elapsed_since "$started"; echo

  say 'Upgrading, removing, purging'
  check_life_of_settings
}

main() {
  local started
  parse_arguments "$@"
  cd "$(project_dir)"
  : "${packages:=$PWD/build/packages}"
  if ((inside)); then
    run_inside
    exit 0
  fi

  started=$(date +%s)
  ((EUID == 0)) || die 'needs root: debootstrap, chroot and namespaces'
  command -v debootstrap >/dev/null || die 'debootstrap is missing: deploy/install-deps.sh test'
  compgen -G "$packages/planemapd_*.deb" >/dev/null || die "no packages in $packages: deploy/package.sh makes them"
  local arguments=() temporary=''
  ((compiler)) || arguments+=(--no-compiler)
  if [[ -z $tree ]]; then
    temporary=$(mktemp -d "${TMPDIR:-/tmp}/planemap-packages.XXXXXX")
    tree=$temporary/debian
  fi
  [[ ! -e $tree ]] || die "$tree exists; --tree takes a folder that is to be made" 2
  run_lintian
  # What is mounted below the tree is so for the script alone, and goes with it.
  local result=0
  unshare --mount --propagation private -- bash "${BASH_SOURCE[0]}" --inside-namespace --packages "$packages" --tree "$tree" \
    "${arguments[@]}" || result=$?
  [[ -z $temporary ]] || rm -rf --one-file-system "$temporary"
  ((result == 0)) || exit 1
  say "The packages are fine; $(elapsed_since "$started") in all"
}

main "$@"
