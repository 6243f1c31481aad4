// SPDX-License-Identifier: BSD-3-Clause
#include "block_memory.h"

#include <cstdlib>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace keepout {
namespace {

constexpr std::size_t line = 64;
constexpr std::size_t huge_page = std::size_t{1} << 21;

constexpr std::size_t rounded_up(std::size_t bytes, std::size_t unit) {
  return (bytes + unit - 1) / unit * unit;
}

}  // namespace

void* allocate_blocks(std::size_t bytes) {
  const std::size_t unit = bytes >= 2 * huge_page ? huge_page : line;
  void* const memory = std::aligned_alloc(unit, rounded_up(bytes, unit));
  if (memory == nullptr) throw std::bad_alloc();
#ifdef __linux__
  // A hint: without huge pages all is the same, only slower.
  if (unit == huge_page) madvise(memory, rounded_up(bytes, unit), MADV_HUGEPAGE);
#endif
  return memory;
}

void free_blocks(void* memory) noexcept { std::free(memory); }

}  // namespace keepout
