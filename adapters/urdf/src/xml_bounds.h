// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string_view>

namespace keepout {

constexpr std::size_t most_bytes_of_urdf = std::size_t{16} << 20;

/// Throws Error for a text that TinyXML cannot handle safely. TinyXML recurses for each level of
/// elements, compares each two attributes of an element, and stops at a zero byte. No real robot
/// comes near the limits.
void require_bounded_xml(std::string_view text);

}  // namespace keepout
