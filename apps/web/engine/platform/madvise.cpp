// SPDX-License-Identifier: BSD-3-Clause
//
// What the C library of emscripten declares and has not.
#include <sys/mman.h>

/// Advice on how memory will be used: nobody there takes any, and nobody has to.
extern "C" int madvise(void*, size_t, int) { return 0; }
