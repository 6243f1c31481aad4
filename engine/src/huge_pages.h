// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "parallel.h"

namespace keepout {

/// Returns a vector of a size, in huge pages if it is large and the system has them. Huge pages are
/// faster to allocate and to access. The system clears them on all processors, not only on the
/// thread that fills the vector with zeros.
template <class T>
std::vector<T> vector_in_huge_pages(std::size_t size) {
  constexpr std::uintptr_t huge = std::uintptr_t{2} << 20;
  std::vector<T> items;
  items.reserve(size);
  const auto begin = (reinterpret_cast<std::uintptr_t>(items.data()) + huge - 1) / huge * huge;
  const auto end = reinterpret_cast<std::uintptr_t>(items.data() + size) / huge * huge;
  if (begin < end) {
    // A hint to the system, which may fail without harm.
    madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
    share_blocks((end - begin) / huge, processors(), [&] {
      return [&](std::size_t block) {
        *reinterpret_cast<volatile char*>(begin + block * huge) = 0;  // the first touch of a page
      };
    });
  }
  items.resize(size);
  return items;
}

}  // namespace keepout
