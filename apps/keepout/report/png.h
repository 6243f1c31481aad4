// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "report/image.h"

namespace keepout::app {

/// The picture as a PNG file. Throws Error when it has no pixels.
std::vector<std::uint8_t> to_png(const Image& image);

}  // namespace keepout::app
