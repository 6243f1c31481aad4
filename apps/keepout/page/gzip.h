// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace keepout::app {

/// Returns a gzip file (RFC 1952), at zlib's best compression. Browsers can decompress it.
std::vector<std::uint8_t> gzipped(std::span<const std::uint8_t> bytes);

}  // namespace keepout::app
