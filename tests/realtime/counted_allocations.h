// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace keepout {

/// Returns the number of allocations on the heap since the program began, by new, malloc or similar
/// functions. Link counted_allocations.cpp, which replaces those of the C library.
std::size_t allocations() noexcept;

}  // namespace keepout
