# SPDX-License-Identifier: BSD-3-Clause
#
# Highway and xxhash, of which the headers are enough: with one instruction set there is no dispatch at
# run time. The engine links xxhash by the name that toolchain.cmake gives.

set(hwy_FOUND TRUE)
if(TARGET hwy::hwy)
  return()
endif()
add_library(hwy::hwy INTERFACE IMPORTED GLOBAL)
target_include_directories(hwy::hwy INTERFACE ${KEEPOUT_PLATFORM_HEADERS})
add_library(keepout_inlined_xxhash INTERFACE IMPORTED GLOBAL)
target_compile_definitions(keepout_inlined_xxhash INTERFACE XXH_INLINE_ALL)
