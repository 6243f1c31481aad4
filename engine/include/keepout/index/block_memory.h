// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace keepout {

/// Memory of at least `bytes`, aligned to a cache line; in pages of 2 MiB where there is much of it
/// and the system has them, for a walk jumps from page to page. Throws std::bad_alloc.
void* allocate_blocks(std::size_t bytes);
void free_blocks(void* memory) noexcept;

/// For std::vector: leaves new elements uninitialised, so that the threads that fill them are the
/// first to touch them.
template <class T>
struct BlockAllocator {
  using value_type = T;

  BlockAllocator() = default;
  template <class U>
  BlockAllocator(const BlockAllocator<U>&) noexcept {}

  T* allocate(std::size_t count) { return static_cast<T*>(allocate_blocks(count * sizeof(T))); }
  void deallocate(T* memory, std::size_t) noexcept { free_blocks(memory); }

  template <class U>
  void construct(U* at) noexcept {
    ::new (static_cast<void*>(at)) U;
  }
  template <class U, class... Arguments>
  void construct(U* at, Arguments&&... arguments) {
    ::new (static_cast<void*>(at)) U(std::forward<Arguments>(arguments)...);
  }

  friend bool operator==(const BlockAllocator&, const BlockAllocator&) noexcept { return true; }
};

template <class T>
using BlockVector = std::vector<T, BlockAllocator<T>>;

}  // namespace keepout
