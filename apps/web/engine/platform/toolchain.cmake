# SPDX-License-Identifier: BSD-3-Clause
#
# keepout for a web page: WebAssembly by Debian's emscripten (clang 14, libc++ 13). Its steps are
# bitwise identical to those of the native library. Findhwy.cmake has the libraries.

find_program(KEEPOUT_EMSCRIPTEN em++ REQUIRED)
mark_as_advanced(KEEPOUT_EMSCRIPTEN)
get_filename_component(emscripten ${KEEPOUT_EMSCRIPTEN} REALPATH)
get_filename_component(emscripten ${emscripten} DIRECTORY)
find_file(KEEPOUT_EMSCRIPTEN_TOOLCHAIN cmake/Modules/Platform/Emscripten.cmake REQUIRED
          HINTS ${emscripten} PATHS /usr/share/emscripten NO_CMAKE_FIND_ROOT_PATH)
mark_as_advanced(KEEPOUT_EMSCRIPTEN_TOOLCHAIN)
include(${KEEPOUT_EMSCRIPTEN_TOOLCHAIN})

# Only the system's headers that are independent of the machine.
set(KEEPOUT_PLATFORM_HEADERS ${CMAKE_BINARY_DIR}/headers)
file(MAKE_DIRECTORY ${KEEPOUT_PLATFORM_HEADERS})
foreach(header hwy xxhash.h)
  find_path(KEEPOUT_FOLDER_OF_${header} ${header} REQUIRED NO_CMAKE_FIND_ROOT_PATH PATHS /usr/include)
  mark_as_advanced(KEEPOUT_FOLDER_OF_${header})
  file(CREATE_LINK ${KEEPOUT_FOLDER_OF_${header}}/${header} ${KEEPOUT_PLATFORM_HEADERS}/${header}
       SYMBOLIC)
endforeach()
find_path(Eigen3_DIR Eigen3Config.cmake REQUIRED NO_CMAKE_FIND_ROOT_PATH
          PATHS /usr/share/eigen3/cmake)
set(KEEPOUT_XXHASH_INCLUDE_DIR ${KEEPOUT_PLATFORM_HEADERS} CACHE PATH "")
set(KEEPOUT_XXHASH_LIBRARY keepout_inlined_xxhash CACHE STRING "")
# The C library has the functions, but no threads: shared memory needs HTTP headers, which a file lacks.
set(CMAKE_HAVE_LIBC_PTHREAD ON CACHE INTERNAL "")

# Without packets, Eigen adds in another order. It must therefore use those of SSE2, which emscripten
# translates. It includes MMX's header without using it, so an empty one is enough. It uses assembly
# for x86 unless the compiler claims to be a newer GCC than clang does by default.
file(CONFIGURE OUTPUT ${KEEPOUT_PLATFORM_HEADERS}/mmintrin.h CONTENT "")
string(JOIN " " CMAKE_CXX_FLAGS_INIT
  -msimd128 -msse2 -fgnuc-version=5.13 -isystem ${KEEPOUT_PLATFORM_HEADERS}
  -include ${CMAKE_CURRENT_LIST_DIR}/standard_library.h
  -fwasm-exceptions)

list(APPEND CMAKE_MODULE_PATH ${CMAKE_CURRENT_LIST_DIR})
