# SPDX-License-Identifier: BSD-3-Clause
#
# Libraries of which the headers do, as no code is chosen while the program runs: there is one
# instruction set. Highway, and xxhash, which the engine links by the name that toolchain.cmake gives.

set(hwy_FOUND TRUE)
if(TARGET hwy::hwy)
  return()
endif()
add_library(hwy::hwy INTERFACE IMPORTED GLOBAL)
target_include_directories(hwy::hwy INTERFACE ${KEEPOUT_PLATFORM_HEADERS})
add_library(keepout_inlined_xxhash INTERFACE IMPORTED GLOBAL)
target_compile_definitions(keepout_inlined_xxhash INTERFACE XXH_INLINE_ALL)
