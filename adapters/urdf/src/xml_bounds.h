// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string_view>

namespace keepout {

constexpr std::size_t most_bytes_of_urdf = std::size_t{16} << 20;

/// Throws Error for a text over which TinyXML would fall: it calls itself for each level of
/// elements, compares each two attributes of one, and stops at a zero byte. No robot comes near.
void require_bounded_xml(std::string_view text);

}  // namespace keepout
