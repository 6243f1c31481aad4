# SPDX-License-Identifier: BSD-3-Clause
#
# keepout_compile_options(TARGET): what every target of ours is compiled with. Nothing is global, so
# that a project that embeds keepout keeps its own flags.

option(KEEPOUT_WARNINGS_AS_ERRORS "Treat our own warnings as errors" OFF)
set(KEEPOUT_SANITIZE "" CACHE STRING "Sanitizers to compile with, as -fsanitize= takes them")

if(PROJECT_IS_TOP_LEVEL AND NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Debug, Release, RelWithDebInfo" FORCE)
endif()

# So that headers are read once and not for each source: those that most sources include are compiled
# before, and sources of tests and command several at a time, which instantiate once what all of them
# use. Off where nobody asks for it, which is how others compile the library: there each source must
# name what it needs (`./test --long` builds the preset bench so).
option(KEEPOUT_SHARE_HEADERS "Precompile headers; compile several sources of tests and command as one" OFF)

# keepout_precompile_headers(TARGET OWNER [HEADERS...]): those of the standard library, Eigen's, and
# HEADERS. Once for all targets that name the same OWNER, which is the first of them: their flags must
# agree. Not with ccache, which finds again what was compiled in another folder only without.
function(keepout_precompile_headers target owner)
  if(NOT KEEPOUT_SHARE_HEADERS OR CMAKE_CXX_COMPILER_LAUNCHER MATCHES ccache)
    return()
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # std::string again, as of -Wrestrict below. The preset bench, without such headers, has them.
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

# keepout_share_headers(TARGET COUNT): compiles so many sources of the target as one. For tests and for
# the command; each source of the library compiles alone.
function(keepout_share_headers target count)
  if(KEEPOUT_SHARE_HEADERS)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${count})
  endif()
endfunction()

function(keepout_compile_options target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
  # A fused multiply-add rounds differently from one machine to the next; our decisions must not.
  target_compile_options(${target} PRIVATE -ffp-contract=off -Wall -Wextra -Wpedantic -Wshadow
                                           -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC 12 takes a double that goes to float and back for the double itself where it packs two
    # such: x - double(float(x)) is 0 then, and what was rounded outward is not. A test stands guard
    # (tests/engine/geometry/float_rounding_test.cpp).
    target_compile_options(${target} PRIVATE -fno-tree-slp-vectorize)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict)  # GCC bug 105651: std::string +
  endif()
  if(KEEPOUT_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(KEEPOUT_SHARE_HEADERS AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # The compiler collects no garbage below 2 GB: it takes 6 % less time, and a third more memory.
    target_compile_options(${target} PRIVATE "SHELL:--param ggc-min-heapsize=2000000")
  endif()
  if(KEEPOUT_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${KEEPOUT_SANITIZE}
                                             -fno-sanitize-recover=all -fno-omit-frame-pointer)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      # Registers are found in half the time for the long functions that checks make of short ones.
      target_compile_options(${target} PRIVATE -fira-region=one)
    endif()
    # Both have vectors of the length that SSE2 has, and so run the same lines.
    target_compile_definitions(${target} PRIVATE "HWY_DISABLED_TARGETS=(HWY_SSSE3|HWY_SSE4)")
    target_link_options(${target} PUBLIC -fsanitize=${KEEPOUT_SANITIZE})
  endif()
  # Position-independent all of them, which programs are in another way.
  get_target_property(type ${target} TYPE)
  if(type MATCHES "LIBRARY" AND NOT type STREQUAL "MODULE_LIBRARY")
    keepout_precompile_headers(${target} keepout_headers)
  endif()
endfunction()

# The precompiled headers of the libraries: a target without definitions of its own, which would have
# to be those of all.
if(KEEPOUT_SHARE_HEADERS)
  find_package(Eigen3 3.4 REQUIRED)
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/headers.cpp CONTENT "")
  add_library(keepout_headers OBJECT ${PROJECT_BINARY_DIR}/headers.cpp)
  target_link_libraries(keepout_headers PRIVATE Eigen3::Eigen)
  keepout_compile_options(keepout_headers)
endif()
