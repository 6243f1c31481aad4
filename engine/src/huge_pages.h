// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "parallel.h"

namespace keepout {

/// Makes a vector of that size, in huge pages where it is large and the system has them: they are
/// faster to get, and to look up in. The system clears them on as many threads as there are
/// processors, not on the one that fills the vector with zeros.
template <class T>
std::vector<T> vector_in_huge_pages(std::size_t size) {
  constexpr std::uintptr_t huge = std::uintptr_t{2} << 20;
  std::vector<T> items;
  items.reserve(size);
  const auto begin = (reinterpret_cast<std::uintptr_t>(items.data()) + huge - 1) / huge * huge;
  const auto end = reinterpret_cast<std::uintptr_t>(items.data() + size) / huge * huge;
  if (begin < end) {
    // Only a wish: that it cannot be had is no error.
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
