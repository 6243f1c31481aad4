#!/usr/bin/env bash
# Like consumer_test.sh, but with pkg-config and the compiler alone.
#   pkg_config_test.sh PREFIX WORK [bare]
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/common.sh"
prefix=$1 work=$2 kind=${3:-}

rm -rf "$work"
mkdir -p "$work"
compiler=${CXX:-c++}
[ "$kind" != bare ] || compiler=$(bare_compiler "$work")
folder=$(library_folder "$prefix")
export PKG_CONFIG_PATH=$folder/pkgconfig
form=
[ -e "$folder/libkeepout.so" ] || form=--static
# The flags contain no blanks within a word.
# shellcheck disable=SC2046
"$compiler" -std=c++20 "$here/consumer/main.cpp" -o "$work/consumer" \
  $(pkg-config --cflags --libs $form keepout)
run_consumer "$work/consumer" "$prefix"

# Compiles as for a machine with wider vectors. The interface exchanges no objects that Eigen aligns for them.
if [ -z "$form" ]; then
  # shellcheck disable=SC2046
  "$compiler" -std=c++20 -DEIGEN_MAX_ALIGN_BYTES=64 "$here/../../examples/05_own_solver.cpp" \
    -o "$work/own_solver" $(pkg-config --cflags --libs keepout)
  LD_LIBRARY_PATH=$folder "$work/own_solver" "$here/cube.obj" | grep 'held back in .* 0 failed'
fi
