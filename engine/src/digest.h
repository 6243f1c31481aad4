// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "read_only_file.h"

namespace keepout {

/// A digest of 128 bits. It detects damage, not malice.
struct Digest {
  std::uint64_t low = 0;
  std::uint64_t high = 0;

  bool operator==(const Digest&) const = default;
};

Digest digest_of(std::span<const std::byte> bytes);

// Returns a digest of the digests of blocks, computed on one thread for each processor.

Digest shared_digest_of(std::span<const std::byte> bytes);

/// Reads bytes from `offset` on, and computes their shared digest. Returns false if the file has
/// too few bytes.
bool read_with_digest(const ReadOnlyFile& file, std::uint64_t offset, std::span<std::byte> bytes,
                      Digest& digest);

}  // namespace keepout
