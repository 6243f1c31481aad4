// SPDX-License-Identifier: BSD-3-Clause
// Counts allocations under the AddressSanitizer of clang, which replaces malloc itself.
#include <sanitizer/allocator_interface.h>

#include "realtime/counted_allocations.h"

namespace {

// libFuzzer has a thread of its own.
thread_local std::size_t count = 0;

const int installed = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t) { ++count; }, [](const volatile void*) {});

}  // namespace

std::size_t keepout::allocations() noexcept { return installed == 0 ? 0 : count; }
