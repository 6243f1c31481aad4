# Completion in bash for keepout and keepout-bench: the program itself prints the candidates.
# SPDX-License-Identifier: BSD-3-Clause
_keepout() {
  mapfile -t COMPREPLY < <("$1" --complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2> /dev/null)
  local last=$((${#COMPREPLY[@]} - 1))
  if ((last >= 0)) && [[ -z ${COMPREPLY[last]} ]]; then # these are mesh names; file names are valid too
    unset "COMPREPLY[last]"
    compopt -o filenames 2> /dev/null
    mapfile -t -O "$last" COMPREPLY < <(compgen -f -- "${COMP_WORDS[COMP_CWORD]}")
  fi
}
complete -o bashdefault -o default -F _keepout keepout keepout-bench
