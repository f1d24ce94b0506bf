#!/usr/bin/env bash
# Writes the manual pages, compressed, from what the programs say of themselves: make_pages.sh BIN_DIR OUT_DIR
# One page a program, and one for each command of planemap. Needs help2man.
set -euo pipefail

if (($# != 2)) || [[ ! -d $1 ]]; then
  echo 'Usage: make_pages.sh BIN_DIR OUT_DIR' >&2
  exit 2
fi
bin_dir=$(cd -- "$1" && pwd)
mkdir -p "$2"
out_dir=$(cd -- "$2" && pwd)
PATH=$bin_dir:$PATH
version=$(planemap --version)

# page "PROGRAM [COMMAND]" SUMMARY: the page is named program-command, as git's are.
page() {
  local name=${1/ /-}
  help2man --no-info --version-string="${version#* }" --name="$2" "$1" |
    sed --regexp-extended "s/^\.TH PLANEMAP[^ ]*( \"1\"|) /.TH ${name^^} \"1\" /; s/^(planemap[^ ]*) ([a-z]+) \\\\- /\1-\2 \\\\- /" |
    gzip --best --no-name >"$out_dir/$name.1.gz"
}

# The commands as planemap lists them, a line each: name and what it does.
commands() {
  planemap --help | sed --regexp-extended --quiet '/^Subcommands:/,/^$/ s/^  ([a-z]+) +(.*)/\1 \2/p'
}

rm -f "$out_dir"/*.1.gz
page planemapd 'makes a map of planes from depth scans and poses'
page planemap 'builds maps of planes and asks planemapd for its map'
page planemap-kinect-bridge 'feeds planemapd with recorded or simulated scans'
while read -r command summary; do
  page "planemap $command" "$summary"
done < <(commands)
