#!/usr/bin/env bash
# Tests that find_package(keepout) provides the requested components, searches only for what they need, and
# reports what is missing.
#   components_test.sh PREFIX static|shared WORK VERSION
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/common.sh"
prefix=$1 form=$2 work=$3 version=$4

rm -rf "$work"
mkdir -p "$work"
cat > "$work/CMakeLists.txt" <<'PROJECT'
cmake_minimum_required(VERSION 3.25)
project(parts LANGUAGES CXX)
separate_arguments(ASK)
find_package(keepout ${ASK})
foreach(part engine solvers adapters monitor nlopt keepout control robot ompl urdf)
  if(TARGET keepout::${part})
    message(STATUS "has ${part}")
  endif()
endforeach()
message(STATUS "version ${keepout_VERSION}, found ${keepout_FOUND}, nonsense ${keepout_nonsense_FOUND}")
PROJECT

# All calls share a build folder, so CMake examines the compiler once.
ask() {
  local words=$1
  shift
  cmake -S "$work" -B "$work/build" -DCMAKE_PREFIX_PATH="$prefix" --no-warn-unused-cli -Wno-dev \
    -DASK="$words" "$@" 2>&1 | tr -s '\n ' ' '
}
says() { [[ $answer == *"$1"* ]] || fail "expected '$1' in: $answer"; }
says_not() { [[ $answer != *"$1"* ]] || fail "unexpected '$1' in: $answer"; }

answer=$(ask "REQUIRED")
for part in engine solvers adapters keepout; do says "has $part"; done
says "version $version, found 1"

without_libraries=(-DCMAKE_DISABLE_FIND_PACKAGE_fcl=ON
  -DCMAKE_DISABLE_FIND_PACKAGE_embree=ON -DCMAKE_DISABLE_FIND_PACKAGE_NLopt=ON)
with_libraries=("${without_libraries[@]/%ON/OFF}")

answer=$(ask "REQUIRED COMPONENTS engine" "${without_libraries[@]}")
says "has engine"
says_not "has solvers"
says_not "has adapters"
says_not "has keepout"

answer=$(ask "REQUIRED COMPONENTS control" "${without_libraries[@]}")
says "has control"
says_not "has adapters"
if [ -e "$(library_folder "$prefix")/cmake/keepout/keepout-ompl-find.cmake" ]; then
  answer=$(ask "REQUIRED COMPONENTS ompl" "${without_libraries[@]}")
  says "has ompl"
  answer=$(ask "REQUIRED COMPONENTS ompl" -DCMAKE_DISABLE_FIND_PACKAGE_ompl=ON) && fail "planning without OMPL"
  says "install libompl-dev"
fi

if [ -e "$(library_folder "$prefix")/cmake/keepout/keepout-urdf.cmake" ]; then
  answer=$(ask "REQUIRED COMPONENTS urdf" "${without_libraries[@]}")
  says "has urdf"
  says "has robot"
  says_not "has adapters"
fi

if [ "$form" = static ]; then
  answer=$(ask "REQUIRED COMPONENTS nlopt" "${without_libraries[@]}") && fail "NLopt's solver without NLopt"
  says "keepout::nlopt needs NLopt, which was not found: install libnlopt-dev"
  answer=$(ask "COMPONENTS engine OPTIONAL_COMPONENTS nlopt" "${without_libraries[@]}")
  says "has engine"
  says_not "has nlopt"
fi
# Modules link the other libraries; a user's program does not.
answer=$(ask "REQUIRED" "${without_libraries[@]}")
says "has keepout"

answer=$(ask "REQUIRED" -DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON "${with_libraries[@]}") &&
  fail "the engine without Eigen"
says "keepout::engine needs Eigen3, which was not found: install libeigen3-dev"

with_libraries+=(-DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=OFF)
answer=$(ask "REQUIRED COMPONENTS engine nonsense" "${with_libraries[@]}") && fail "nonsense was found"
says "keepout has no component 'nonsense'"
says "there are: engine, "
answer=$(ask "REQUIRED COMPONENTS engine OPTIONAL_COMPONENTS nonsense")
says "found 1, nonsense FALSE"

IFS=. read -r major minor patch <<< "$version"
answer=$(ask "$major.$minor.$patch REQUIRED")
says "found 1"
for other in "$major.$((minor + 1))" "$major.$minor.$((patch + 1))" "$((major + 1)).0"; do
  answer=$(ask "$other REQUIRED") && fail "$version is not $other"
  says "version: $version"
done
