#!/usr/bin/env bash
# Tests that a project with add_subdirectory(keepout) gets its targets, but not its tests and installed files.
#   embedded_test.sh SOURCE WORK
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/common.sh"
source=$1 work=$2

rm -rf "$work"
mkdir -p "$work"
cp "$here/consumer/main.cpp" "$work"
cat > "$work/CMakeLists.txt" <<PROJECT
cmake_minimum_required(VERSION 3.25)
project(embedding LANGUAGES CXX)
add_subdirectory($source keepout)
add_executable(consumer main.cpp)
target_link_libraries(consumer PRIVATE keepout::keepout)
install(TARGETS consumer)
PROJECT
for form in OFF ON; do
  cmake -S "$work" -B "$work/build" -G Ninja -DBUILD_SHARED_LIBS=$form
  ninja -C "$work/build" -t targets all > "$work/targets"
  for other in keepout_engine_packaged packages keepout_app 01_keep_out geometry_test; do
    ! grep -q "^$other:" "$work/targets" || fail "an embedding project gets $other"
  done
  ! grep -rq -e 'keepout-config' "$work/build/cmake_install.cmake" "$work/build/keepout/cmake_install.cmake" ||
    fail "an embedding project installs keepout"
done
grep -q '^keepout/engine/libkeepout_engine.so' "$work/targets" || fail "BUILD_SHARED_LIBS makes no shared library"
