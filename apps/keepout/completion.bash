# Completion in bash for keepout and keepout-bench: the program itself says what may come next.
# SPDX-License-Identifier: BSD-3-Clause
_keepout() {
  mapfile -t COMPREPLY < <("$1" --complete "${COMP_WORDS[@]:1:COMP_CWORD}" 2> /dev/null)
}
complete -o bashdefault -o default -F _keepout keepout keepout-bench
