#!/usr/bin/env bash
# Tests that `cmake --install` installs nothing that may not be redistributed, and no path of the source.
#   prefix_test.sh PREFIX SOURCE
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/common.sh"
prefix=$1 source=$2

for forbidden in cgal gpl real_mesh oracle; do
  found=$(find "$prefix" -iname "*$forbidden*")
  [ -z "$found" ] || fail "not to be installed: $found"
done
found=$(grep -rlF "$source" "$prefix" || true)
[ -z "$found" ] || fail "a path of this machine is in: $found"
"$prefix/bin/keepout" --version
