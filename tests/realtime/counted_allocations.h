// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace keepout {

/// How often the heap was asked for memory since the program began, by new, malloc or any other of
/// their kind. Link counted_allocations.cpp, which stands in for the C library's.
std::size_t allocations() noexcept;

}  // namespace keepout
