// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "read_only_file.h"

namespace keepout {

/// 128 bits that tell contents apart: damage is found, malice is not.
struct Digest {
  std::uint64_t low = 0;
  std::uint64_t high = 0;

  bool operator==(const Digest&) const = default;
};

Digest digest_of(std::span<const std::byte> bytes);

// Made of the digests of blocks, on as many threads as there are processors.

Digest shared_digest_of(std::span<const std::byte> bytes);

/// Reads bytes from `offset` on, and gives them their shared digest; false if they are not all to
/// be had.
bool read_with_digest(const ReadOnlyFile& file, std::uint64_t offset, std::span<std::byte> bytes,
                      Digest& digest);

}  // namespace keepout
