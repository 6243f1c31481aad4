// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace keepout::app {

/// What this thread has asked of the heap and of locks since it began. malloc and its kin, and
/// pthread's mutexes and locks, are counted as they are called, by standing in for them.
struct CallCounts {
  std::size_t allocations = 0;
  std::size_t locks = 0;
};

/// Whether this build counts: one with a sanitizer does not, for that stands in for them too.
bool counts_calls() noexcept;

CallCounts calls_of_this_thread() noexcept;

}  // namespace keepout::app
