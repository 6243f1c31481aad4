#!/usr/bin/env bash
# Tests that public headers compile without third-party headers other than Eigen's: all of them together, and
# each alone. Those of keepout::testing need GoogleTest, and are not among them.
#   headers_test.sh INCLUDE WORK
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/common.sh"
include=$1 work=$2

rm -rf "$work"
mkdir -p "$work/alone"
compiler=$(bare_compiler "$work")
count=0
while read -r header; do
  printf '#include "%s"\n' "$header" >> "$work/all.cpp"
  printf '#include "%s"\n#include "%s"\n' "$header" "$header" > "$work/alone/$count.cpp"
  count=$((count + 1))
done < <(cd "$include" && find . -name '*.h' -not -path './keepout/testing/*' -printf '%P\n' | sort)
[ $count -gt 30 ] || fail "only $count headers to compile alone: has something moved?"
# shellcheck disable=SC2046
printf '%s\n' "$work/all.cpp" "$work"/alone/*.cpp | xargs -n1 -P2 \
  "$compiler" -std=c++20 -Wall -Wextra -Werror -fsyntax-only -I "$include" $(pkg-config --cflags eigen3)
printf '%s headers alone, all together\n' "$count"
