# Sourced by the tests of this folder.
# SPDX-License-Identifier: BSD-3-Clause
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

fail() { printf '%s\n' "$*" >&2; exit 1; }

# Prints the folder of a prefix that has its files of CMake and pkg-config.
library_folder() { dirname "$(dirname "$(find "$1" -path '*/pkgconfig/keepout.pc')")"; }

# The consumer commands 1 aside and 4 down, from 2 above the cube, with a margin of 0.5.
run_consumer() {
  local answer
  answer=$(LD_LIBRARY_PATH=$(library_folder "$2") "$1" "$here/cube.obj")
  [ "$answer" = "1.000000 -1.500000: constraints limit the motion to the nearest one that they allow: \`limits\` names them" ] ||
    fail "the consumer answers: $answer"
}

# bare_compiler FOLDER: makes a compiler and prints its path. The compiler finds only the headers of C, C++
# and the kernel, and those of -I.
bare_compiler() {
  local compiler=${CXX:-c++} folder=$1 version architecture includes= path
  version=$("$compiler" -dumpversion)
  architecture=$(dpkg --print-architecture)  # packages of others may be installed beside
  mkdir -p "$folder/headers"
  dpkg -L {libc6-dev,linux-libc-dev,"libstdc++-${version%%.*}-dev"}:"$architecture" | grep '^/usr/include/' |
    while read -r path; do [ -d "$path" ] || printf '%s\n' "$path"; done |
    (cd "$folder/headers" && xargs cp --parents -sft .)
  # In the search order of the compiler.
  while read -r path; do
    path=$(realpath -m "$path")
    case $path in
      /usr/local/*) ;;
      /usr/include | /usr/include/*) includes+=" -isystem $folder/headers$path" ;;
      *) includes+=" -isystem $path" ;;
    esac
  done < <("$compiler" -E -v -x c++ /dev/null 2>&1 >/dev/null | sed -n '/#include </,/^End/s/^ //p')
  printf '#!/bin/sh\nexec %s -nostdinc%s "$@"\n' "$compiler" "$includes" > "$folder/bare_compiler"
  chmod +x "$folder/bare_compiler"
  printf '#include <fcl/config.h>\n' > "$folder/foreign.cpp"
  ! "$folder/bare_compiler" -fsyntax-only "$folder/foreign.cpp" 2>/dev/null ||
    fail "the bare compiler finds the headers of FCL"
  printf '%s\n' "$folder/bare_compiler"
}
