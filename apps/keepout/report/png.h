// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "report/image.h"

namespace keepout::app {

/// The picture as a PNG file. Throws Error when it has no pixels.
std::vector<std::uint8_t> to_png(const Image& image);

/// Base64 with padding (RFC 4648, section 4).
std::string to_base64(std::span<const std::uint8_t> bytes);

}  // namespace keepout::app
