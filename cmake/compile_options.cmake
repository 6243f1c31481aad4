# SPDX-License-Identifier: BSD-3-Clause
#
# keepout_compile_options(TARGET): sets the compile options of a target of keepout. Nothing is
# global, so a project that embeds keepout keeps its own flags.

option(KEEPOUT_WARNINGS_AS_ERRORS "Treat our own warnings as errors" OFF)
set(KEEPOUT_SANITIZE "" CACHE STRING "Sanitizers to compile with, as -fsanitize= takes them")

if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Debug, Release, RelWithDebInfo" FORCE)
endif()

# Saves build time: precompiles the headers that most sources include, and compiles several sources
# of tests and command as one. Off by default, as others compile the library. Each source must then
# include the headers that it needs: `./test --long` checks that with the preset bench.
option(KEEPOUT_SHARE_HEADERS "Precompile headers; compile several sources of tests and command as one" OFF)

# keepout_precompile_headers(TARGET OWNER [HEADERS...]): precompiles headers of the standard
# library, Eigen's, and HEADERS. All targets with the same OWNER, which is the first of them, share
# the result: their flags must agree. Not with ccache, which reuses results from another folder only
# without precompiled headers.
function(keepout_precompile_headers target owner)
  if(NOT KEEPOUT_SHARE_HEADERS OR CMAKE_CXX_COMPILER_LAUNCHER MATCHES ccache)
    return()
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # False warnings for std::string, like -Wrestrict below. The preset bench, without such headers,
    # enables these warnings.
    target_compile_options(${target} PRIVATE -Wno-array-bounds -Wno-stringop-overflow
                                             -Wno-stringop-overread)
  endif()
  if(NOT target STREQUAL owner)
    target_precompile_headers(${target} REUSE_FROM ${owner})
    return()
  endif()
  target_precompile_headers(${target} PRIVATE
    <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <limits> <map> <memory>
    <numeric> <optional> <random> <span> <sstream> <string> <string_view> <utility> <vector>
    <Eigen/Dense> ${ARGN})
endfunction()

# keepout_share_headers(TARGET COUNT): compiles COUNT sources of the target as one. For tests and
# the command; each source of the library compiles alone.
function(keepout_share_headers target count)
  if(KEEPOUT_SHARE_HEADERS)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${count})
  endif()
endfunction()

function(keepout_compile_options target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
  if(EMSCRIPTEN)
    # A module of its own needs no position-independent code, which would be larger.
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
  endif()
  # No fused multiply-add: it rounds differently on different machines, but decisions must be equal.
  target_compile_options(${target} PRIVATE -ffp-contract=off -Wall -Wextra -Wpedantic -Wshadow
                                           -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC 12 omits the conversion of a double to float and back if it vectorizes two of them. Then x
    # - double(float(x)) is 0, and values are not rounded outward. Tested by
    # tests/engine/geometry/float_rounding_test.cpp.
    target_compile_options(${target} PRIVATE -fno-tree-slp-vectorize)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict)  # GCC bug 105651: std::string +
  endif()
  if(KEEPOUT_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(KEEPOUT_SHARE_HEADERS AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # No garbage collection in the compiler below 2 GB: 6 % less time, and a third more memory.
    target_compile_options(${target} PRIVATE "SHELL:--param ggc-min-heapsize=2000000")
  endif()
  if(KEEPOUT_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${KEEPOUT_SANITIZE}
                                             -fno-sanitize-recover=all -fno-omit-frame-pointer)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      # Sanitizer checks make functions long; this halves the time of register allocation.
      target_compile_options(${target} PRIVATE -fira-region=one)
    endif()
    target_link_options(${target} PUBLIC -fsanitize=${KEEPOUT_SANITIZE})
  endif()
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
    # Vectors of SVE have no size at compile time, so they cannot be members. NEON remains.
    set(disabled "HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128")
    # Highway's NEON contains AES, which keepout does not use. GCC 12 compiles implicit constructors
    # without the target of the surrounding pragma, so NEON must be the target of the whole file.
    target_compile_options(${target} PRIVATE -march=armv8-a+crypto)
    # Eigen then multiplies and adds separately, as on x86-64 without FMA instructions.
    target_compile_options(${target} PRIVATE -U__ARM_FEATURE_FMA)
  elseif(KEEPOUT_SANITIZE)
    set(disabled "HWY_SSSE3|HWY_SSE4")  # they have the vector length of SSE2, and so run the same lines
  endif()
  if(DEFINED disabled)
    target_compile_definitions(${target} PRIVATE "HWY_DISABLED_TARGETS=(${disabled})")
  endif()
  # Libraries only: they are position-independent, and programs use other flags for that.
  get_target_property(type ${target} TYPE)
  if(type MATCHES "LIBRARY" AND NOT type STREQUAL "MODULE_LIBRARY")
    keepout_precompile_headers(${target} keepout_headers)
  endif()
endfunction()

# The precompiled headers of the libraries: a target without definitions, because all targets would
# need the same ones.
if(KEEPOUT_SHARE_HEADERS)
  find_package(Eigen3 3.4 REQUIRED)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/headers.cpp CONTENT "")
  add_library(keepout_headers OBJECT ${PROJECT_BINARY_DIR}/headers.cpp)
  target_link_libraries(keepout_headers PRIVATE Eigen3::Eigen)
  keepout_compile_options(keepout_headers)
endif()
