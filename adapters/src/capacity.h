// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string_view>

namespace keepout {

/// Throws Error when `count` is more than `most`, what the data structure of the index of that name
/// can hold. `items` says what is counted: triangles or vertices.
void require_at_most(std::size_t most, std::size_t count, std::string_view items,
                     std::string_view index);

}  // namespace keepout
