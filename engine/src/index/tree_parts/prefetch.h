// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace keepout {

/// Prefetches all cache lines of a block that will be needed soon.
template <class Block>
[[gnu::always_inline]] inline void prefetch(const Block& block) noexcept {
  constexpr std::size_t line = 64;
  const char* bytes = reinterpret_cast<const char*>(&block);
  for (std::size_t at = 0; at < sizeof block; at += line) __builtin_prefetch(bytes + at);
}

}  // namespace keepout
