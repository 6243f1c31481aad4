#!/usr/bin/env bash
# Tests that a project outside of keepout finds it in a prefix, builds and runs. With `bare`, only Eigen is
# there.
#   consumer_test.sh PREFIX WORK [bare]
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/common.sh"
prefix=$1 work=$2 kind=${3:-}

rm -rf "$work"
mkdir -p "$work"
options=()
if [ "$kind" = bare ]; then
  options+=(-DCMAKE_CXX_COMPILER="$(bare_compiler "$work")")
  for package in fcl ccd octomap embree Bullet NLopt hwy CGAL Threads; do
    options+=(-DCMAKE_DISABLE_FIND_PACKAGE_$package=ON)
  done
fi
cmake -S "$here/consumer" -B "$work/build" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_BUILD_TYPE=Release \
  --no-warn-unused-cli "${options[@]}"
cmake --build "$work/build"
run_consumer "$work/build/consumer" "$prefix"
answer=$(LD_LIBRARY_PATH=$(library_folder "$prefix") "$work/build/consumer" 2>&1) && fail "no mesh, and no error"
[ "$answer" = "usage: consumer MESH" ] || fail "without a mesh the consumer says: $answer"

# docs/embedding.md must show the same programs. The second one is built with the tests.
sed -n '/^```cpp$/,/^```$/p' "$here/../../docs/embedding.md" | sed '/^```/d' |
  cmp - <(cat "$here"/consumer/{main,instrument}.cpp) || fail "docs/embedding.md shows another program"
