# shellcheck shell=bash
# Completion of planemapd, planemap and planemap-kinect-bridge for bash, by the package bash-completion. It reads what the
# programs say to --help, so it knows what they know.

# The word that names the value of an option, as --help has it: FILE, {best,paper}, ...; nothing where it takes none.
_planemap_value_of() {
  local option=$1 help=$2 line
  line=$(grep --extended-regexp --max-count=1 -- "^ +(-[a-zA-Z],)?$option( |\$)" <<<"$help") ||
    line=$(grep --extended-regexp --max-count=1 -- "^ +$option," <<<"$help") || return
  line=${line#*"$option"}
  [[ $option == --* ]] || line=${line#,--*([a-z-])}
  # Options that take none are followed by many blanks, or by what they go with.
  [[ $line =~ ^' '([^ ]+) ]] || return
  case ${BASH_REMATCH[1]} in
    Excludes: | Needs: | REQUIRED) return ;;
  esac
  printf '%s\n' "${BASH_REMATCH[1]}"
}

_planemap() {
  local cur prev words cword
  _init_completion -n : || return
  local asked=("$1") help value shopt_before
  shopt_before=$(shopt -p extglob)
  shopt -s extglob
  if [[ ${1##*/} == planemap ]] && ((cword > 1)); then asked+=("${words[1]}"); fi
  help=$("${asked[@]}" --help 2>/dev/null)

  value=''
  [[ $prev != -* ]] || value=$(_planemap_value_of "$prev" "$help")
  if [[ $value =~ \{(.*)\} || $value =~ ^([a-z|]+\|[a-z|]+) ]]; then
    mapfile -t COMPREPLY < <(compgen -W "${BASH_REMATCH[1]//[,|]/ }" -- "$cur")
  elif [[ $value == @(FILE|OUT|TEXT:PATH|*FILE*) ]]; then
    _filedir
  elif [[ $value == @(FOLDER|DIR|*DIR*) ]]; then
    _filedir -d
  elif [[ -n $value ]]; then
    COMPREPLY=()  # a number or a name: nobody can guess it
  elif [[ $cur == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(grep --extended-regexp '^ +-' <<<"$help" | grep --extended-regexp --only-matching -- '^ +(-[a-zA-Z],)?--[a-z-]+' | grep --only-matching -- '--.*')" -- "$cur")
  elif [[ ${1##*/} == planemap ]] && ((cword == 1)); then
    mapfile -t COMPREPLY < <(compgen -W "$(sed --quiet --regexp-extended '/^Subcommands:/,/^$/ s/^  ([a-z]+) .*/\1/p' <<<"$help")" -- "$cur")
  else
    _filedir
  fi
  $shopt_before
}

complete -F _planemap planemapd planemap planemap-kinect-bridge
