#!/usr/bin/env bash
# Installs the Debian packages that planemap needs. Asks dpkg first, so a second run takes no time and no network.
set -euo pipefail
export LC_ALL=C

usage() {
  cat <<'USAGE'
Usage: install-deps.sh [--list] [run|build|package|test|all]...

Installs the Debian 12 packages that planemap needs; as root, or through sudo.
  run      to run planemapd, planemap and planemap-kinect-bridge (and the demo)
  build    to build them
  package  to make Debian packages of them, besides build
  test     to build and run the tests and the checks of CI
  all      all of them (default)

  --list     print the packages instead of installing them
  -h, --help this text

Exit codes: 0 all is installed, 1 failed, 2 wrong use.
USAGE
}

readonly RUN_PACKAGES=(
  iproute2            # the demo's network namespace
  jq                  # the demo reads the daemon's status with it
  libgrpc++1.51
  libhwy1
  liblcm1
  libpcl-io1.13
  libpng16-16
  libprometheus-cpp-core1.0
  libprotobuf32
  libspdlog1.10
  libsqlite3-0
  libsystemd0
  libyaml-cpp0.7
  util-linux          # unshare, taskset
  zlib1g
)
readonly BUILD_PACKAGES=(
  ccache
  cmake
  g++
  libboost-dev
  libcli11-dev
  libeigen3-dev
  libexpected-dev
  libgrpc++-dev
  libhwy-dev
  liblcm-bin          # lcm-gen
  liblcm-dev
  libpcl-dev
  libpng-dev
  libprotobuf-dev
  libspdlog-dev
  libsqlite3-dev
  libsystemd-dev
  libyaml-cpp-dev
  ninja-build
  nlohmann-json3-dev
  prometheus-cpp-dev
  protobuf-compiler
  protobuf-compiler-grpc
  zlib1g-dev
)
readonly PACKAGE_PACKAGES=(
  dpkg-dev            # dpkg-shlibdeps
  help2man
)
readonly TEST_PACKAGES=(
  bash-completion
  chromium            # shows the viewer's page
  clang               # the fuzz targets
  clang-format
  clang-tidy
  debootstrap         # a Debian to install the packages into
  git                 # CI asks it which files are the project's
  help2man            # manual pages
  iproute2
  jq
  libclang-rt-14-dev  # libFuzzer and the sanitizers of clang
  libbenchmark-dev    # planemap-query-bench, planemap-stage-bench
  libgmock-dev
  libgtest-dev
  libxml2-utils       # xmllint: is the floor plan well-formed?
  liblcm-bin          # lcm-logplayer, lcm-logger
  liboctomap-dev      # a peer, for planemap-bench
  lintian             # looks at the packages
  man-db
  nftables            # loses datagrams on purpose
  mypy                # types of the Python package
  openssl             # certificates of the tests
  python3             # run-clang-tidy
  python3-grpcio      # this and the next ones: the Python package, its example and tests
  python3-matplotlib
  python3-numpy
  python3-protobuf
  python3-pytest
  python3-yaml        # reads the compose file
  shellcheck
  systemd             # systemd-analyze
  util-linux
)

die() {
  printf 'install-deps.sh: %s\n' "$1" >&2
  exit "${2:-1}"
}

# Prints those of its arguments that are not installed.
missing_packages() {
  local installed
  installed=$(dpkg-query --show --showformat '${Package} ${db:Status-Status}\n' "$@" 2>/dev/null |
    sed -n 's/ installed$//p') || true
  comm -23 <(printf '%s\n' "$@" | sort -u) <(sort -u <<<"$installed")
}

check_system() {
  local id='unknown' version='unknown'
  if [[ -r /etc/os-release ]]; then
    # shellcheck source=/dev/null
    id=$(. /etc/os-release && echo "${ID:-unknown}")
    # shellcheck source=/dev/null
    version=$(. /etc/os-release && echo "${VERSION_ID:-unknown}")
  fi
  command -v apt-get >/dev/null && [[ $id == debian && $version == 12 ]] && return
  die "this script knows Debian 12, here is $id $version. Install by hand what stands for these packages:
  $*"
}

# Runs apt-get quietly; what it said is shown if it fails.
apt_get() {
  local log=$1
  shift
  local as_root=()
  ((EUID == 0)) || as_root=(sudo)
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q \
    -o Acquire::Retries=3 -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0 "$@" >>"$log" 2>&1 </dev/null && return
  tail -n 30 "$log" >&2
  die "'apt-get $1' failed; all it said is in $log. Is the network there, and do the sources of apt name Debian 12 (main)?"
}

install_packages() {
  local log
  if ((EUID != 0)) && ! command -v sudo >/dev/null; then
    die "needs root to install: $*. Run it as root, or install sudo."
  fi
  log=$(mktemp "${TMPDIR:-/tmp}/planemap-install-deps.XXXXXX.log")
  ((EUID == 0)) || sudo -v || die "sudo did not let us in; ask who runs this machine to install: $*"
  printf 'Installing %d packages and what they need: %s\n' "$#" "$*"
  printf 'This may take some minutes; apt-get writes to %s\n' "$log"
  apt_get "$log" update
  apt_get "$log" install --yes --no-install-recommends "$@"
  rm -f "$log"
}

main() {
  local list_only=0 needs_npm=0 packages=() missing
  local groups=()
  for argument in "$@"; do
    case $argument in
      -h | --help) usage; exit 0 ;;
      --list) list_only=1 ;;
      run | build | package | test | all) groups+=("$argument") ;;
      *) usage >&2; die "what is '$argument'? It takes run, build, package, test and all." 2 ;;
    esac
  done
  ((${#groups[@]})) || groups=(all)
  for group in "${groups[@]}"; do
    case $group in
      run) packages+=("${RUN_PACKAGES[@]}") ;;
      build) packages+=("${BUILD_PACKAGES[@]}"); needs_npm=1 ;;
      package) packages+=("${PACKAGE_PACKAGES[@]}") ;;
      test) packages+=("${TEST_PACKAGES[@]}") ;;
      all) packages+=("${RUN_PACKAGES[@]}" "${BUILD_PACKAGES[@]}" "${PACKAGE_PACKAGES[@]}" "${TEST_PACKAGES[@]}"); needs_npm=1 ;;
    esac
  done
  # npm builds the viewer's page. Debian's package conflicts where node and npm come from elsewhere, so only where there is none.
  if ((needs_npm)) && ! command -v npm >/dev/null; then packages+=(nodejs npm); fi
  mapfile -t packages < <(printf '%s\n' "${packages[@]}" | sort -u)
  if ((list_only)); then
    printf '%s\n' "${packages[@]}"
    exit 0
  fi

  check_system "${packages[@]}"
  mapfile -t missing < <(missing_packages "${packages[@]}")
  if ((${#missing[@]})); then
    install_packages "${missing[@]}"
    mapfile -t missing < <(missing_packages "${packages[@]}")
    ((${#missing[@]} == 0)) || die "apt-get ended well, yet these are not installed: ${missing[*]}"
  fi
  printf 'Packages for %s: all %d installed.\n' "${groups[*]}" "${#packages[@]}"
}

main "$@"
