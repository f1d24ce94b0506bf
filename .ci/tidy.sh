#!/usr/bin/env bash
# Runs clang-tidy over our own sources, with the compile commands of a build: tidy.sh BUILD_DIR [FILE_PATTERN]
# Every finding is an error (.clang-tidy). TIDY_ANALYZER=deep lets the analyzer follow calls further, in twice the time.
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."

build_dir=${1:?"usage: tidy.sh BUILD_DIR [FILE_PATTERN]"}
pattern=${2:-.}
[[ -f $build_dir/compile_commands.json ]] || {
  echo "tidy.sh: $build_dir has no compile_commands.json; configure it first" >&2
  exit 1
}

# What is shipped: the tests would double the time. PCL's headers take half a minute a file and bring no
# code of ours; in Boost.Geometry's the analyzer finds what is not there.
mapfile -t files < <(git ls-files 'core/*.cpp' 'service/*.cpp' 'clients/*.cpp' |
  xargs grep --files-without-match --extended-regexp '#include <(pcl|boost/geometry)' |
  grep --extended-regexp -- "$pattern")
((${#files[@]})) || {
  echo "tidy.sh: no file matches $pattern" >&2
  exit 1
}
echo "clang-tidy: ${#files[@]} files"
work_dir=$(mktemp -d)
trap 'rm -rf "$work_dir"' EXIT
log=$work_dir/log
# GCC's precompiled headers are nothing to clang; and each file must include what it uses.
sed 's# -Winvalid-pch -include [^ ]*/cmake_pch\.hxx# #' "$build_dir/compile_commands.json" >"$work_dir/compile_commands.json"
analyzer=(--extra-arg=-Xclang --extra-arg=-analyzer-config --extra-arg=-Xclang --extra-arg=mode="${TIDY_ANALYZER:-shallow}")
if printf '%s\0' "${files[@]}" |
  xargs -0 -n 1 -P "$(nproc)" clang-tidy -p "$work_dir" --quiet "${analyzer[@]}" >"$log" 2>/dev/null; then
  exit 0
fi
sort -u "$log" | grep --extended-regexp 'error:|warning:' || cat "$log"
exit 1
