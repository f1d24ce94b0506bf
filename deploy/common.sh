# shellcheck shell=bash
# What the scripts of this folder share; sourced, not run.

# The folder of the project.
project_dir() {
  cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd
}

say() {
  printf '\n== %s\n' "$*"
}

# Ends the script: die MESSAGE [EXIT_CODE]
die() {
  printf '%s: %s\n' "$(basename -- "$0")" "$1" >&2
  exit "${2:-1}"
}

# The seconds since $1 (of date +%s) in words a person reads.
elapsed_since() {
  local seconds=$(($(date +%s) - $1))
  printf '%d min %02d s' $((seconds / 60)) $((seconds % 60))
}

# Fails with words if an option has no value: need_value OPTION NUMBER_OF_ARGUMENTS_LEFT
need_value() {
  (($2 >= 2)) || die "$1 takes a value; see --help" 2
}

# One job a core, but a job takes up to 1.5 GB: fewer on small machines.
build_jobs() {
  local cores memory_kb by_memory
  cores=$(nproc)
  memory_kb=$(awk '/^MemAvailable:/ {print $2}' /proc/meminfo)
  by_memory=$((memory_kb / 1500000))
  ((by_memory >= 1)) || by_memory=1
  echo $((cores < by_memory ? cores : by_memory))
}
