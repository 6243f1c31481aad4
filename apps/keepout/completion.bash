# Completion in bash for keepout and keepout-bench: the program itself says what may come next.
# SPDX-License-Identifier: BSD-3-Clause
_keepout() {
  mapfile -t COMPREPLY < <("$1" --complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2> /dev/null)
  local last=$((${#COMPREPLY[@]} - 1))
  if ((last >= 0)) && [[ -z ${COMPREPLY[last]} ]]; then # these name meshes, and so do files
    unset "COMPREPLY[last]"
    compopt -o filenames 2> /dev/null
    mapfile -t -O "$last" COMPREPLY < <(compgen -f -- "${COMP_WORDS[COMP_CWORD]}")
  fi
}
complete -o bashdefault -o default -F _keepout keepout keepout-bench
