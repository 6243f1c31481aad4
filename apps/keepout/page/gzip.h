// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace keepout::app {

/// As a gzip file (RFC 1952), which browsers decompress by themselves; as small as zlib makes it.
std::vector<std::uint8_t> gzipped(std::span<const std::uint8_t> bytes);

}  // namespace keepout::app
