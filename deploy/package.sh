#!/usr/bin/env bash
# Makes the Debian packages.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=common.sh
. "$(dirname -- "${BASH_SOURCE[0]}")/common.sh"

usage() {
  cat <<'USAGE'
Usage: package.sh [--no-install] [--out DIR]

Builds planemap without its tests (build/package) and makes Debian packages of it:
  planemapd         the daemon with its systemd unit, settings (/etc/planemap/planemapd.yaml) and receive buffer (sysctl)
  planemap-tools    planemap and planemap-kinect-bridge
  libplanemap-dev   the C++ client library, the LCM types and the protobuf files
  python3-planemap  the Python client
All but the last with manual pages and, for bash, completion. deploy/test_packages.sh tries them out.

  --out DIR       where the packages go (default build/packages); those of before are replaced
  --no-install    take what this needs as it is
  -h, --help      this text

Exit codes: 0 done, 1 failed, 2 wrong use.
USAGE
}

main() {
  local out='' install=1 started jobs
  while (($#)); do
    case $1 in
      -h | --help) usage; exit 0 ;;
      --out) need_value "$1" $#; out=$2; shift ;;
      --no-install) install=0 ;;
      *) usage >&2; die "what is '$1'?" 2 ;;
    esac
    shift
  done
  started=$(date +%s)
  [[ -z $out ]] || out=$(realpath --canonicalize-missing -- "$out")
  cd "$(project_dir)"
  : "${out:=$PWD/build/packages}"
  ((install == 0)) || deploy/install-deps.sh build package

  # What is dated in the packages is so by the last change, so the same sources give the same dates.
  if [[ -z ${SOURCE_DATE_EPOCH:-} ]]; then
    SOURCE_DATE_EPOCH=$(git log -1 --format=%ct 2>/dev/null) || SOURCE_DATE_EPOCH=$(stat --format=%Y CHANGELOG.md)
  fi
  export SOURCE_DATE_EPOCH

  jobs=$(build_jobs)
  say "Building ($jobs jobs)"
  cmake --preset package
  cmake --build --preset package --parallel "$jobs" --target planemap_packaged

  say 'Packing'
  local work="$PWD/build/package/packages"
  rm -rf "$work"
  (cd build/package && cpack -B "$work")
  mkdir -p "$out"
  rm -f "$out"/{planemapd,planemap-tools,libplanemap-dev,python3-planemap}_*.deb
  mv "$work"/*.deb "$out/"
  say "Packages in $out; $(elapsed_since "$started") in all"
  ls -sh --sort=none "$out"
}

main "$@"
