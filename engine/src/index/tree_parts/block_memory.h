// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace keepout {

/// Memory of at least `bytes`, aligned to a cache line; in pages of 2 MiB where there is much of it
/// and the system has them, for a traversal jumps from page to page. Throws std::bad_alloc.
void* allocate_blocks(std::size_t bytes);
/// Gives back what allocate_blocks gave; null is allowed.
void free_blocks(void* memory) noexcept;

/// For std::vector: leaves new elements uninitialized, so that the threads that fill them are the
/// first to touch them.
template <class T>
struct BlockAllocator {
  using value_type = T;  // as std::allocator_traits asks

  BlockAllocator() = default;
  /// All are alike, whatever the type: there is no state.
  template <class U>
  BlockAllocator(const BlockAllocator<U>&) noexcept {}

  /// Room for `count` items, aligned to a cache line. Throws std::bad_alloc.
  T* allocate(std::size_t count) { return static_cast<T*>(allocate_blocks(count * sizeof(T))); }
  /// Gives it back.
  void deallocate(T* memory, std::size_t) noexcept { free_blocks(memory); }

  /// An item without a value: its memory stays untouched.
  template <class U>
  void construct(U* at) noexcept {
    ::new (static_cast<void*>(at)) U;
  }
  /// An item made from arguments.
  template <class U, class... Arguments>
  void construct(U* at, Arguments&&... arguments) {
    ::new (static_cast<void*>(at)) U(std::forward<Arguments>(arguments)...);
  }

  /// What one has given, any other may give back.
  friend bool operator==(const BlockAllocator&, const BlockAllocator&) noexcept { return true; }
};

/// A vector in such memory, whose new elements have no value yet.
template <class T>
using BlockVector = std::vector<T, BlockAllocator<T>>;

}  // namespace keepout
