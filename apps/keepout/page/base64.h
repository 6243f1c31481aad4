// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace keepout::app {

/// Returns Base64 with padding (RFC 4648, section 4), the form of bytes in a page.
std::string to_base64(std::span<const std::uint8_t> bytes);

}  // namespace keepout::app
