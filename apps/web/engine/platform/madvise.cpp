// SPDX-License-Identifier: BSD-3-Clause
//
// Defines a function that the C library of emscripten only declares.
#include <sys/mman.h>

/// Ignores the advice on the use of memory, which is optional.
extern "C" int madvise(void*, size_t, int) { return 0; }
