// SPDX-License-Identifier: BSD-3-Clause
#include "digest.h"

#include <xxhash.h>

#include <algorithm>
#include <atomic>
#include <vector>

#include "parallel.h"

namespace keepout {
namespace {

constexpr std::size_t block_size = std::size_t{1} << 20;

/// Calls prepare(offset, size) for every block before its digest is computed.
template <class Prepare>
Digest digest_of_blocks(std::span<const std::byte> bytes, const Prepare& prepare) {
  std::vector<Digest> digests((bytes.size() + block_size - 1) / block_size);
  share_blocks(digests.size(), processors(), [&] {
    return [&](std::size_t b) {
      const std::size_t offset = b * block_size;
      const auto block = bytes.subspan(offset, std::min(block_size, bytes.size() - offset));
      prepare(offset, block.size());
      digests[b] = digest_of(block);
    };
  });
  return digest_of(std::as_bytes(std::span(digests)));
}

}  // namespace

Digest digest_of(std::span<const std::byte> bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return {hash.low64, hash.high64};
}

Digest shared_digest_of(std::span<const std::byte> bytes) {
  return digest_of_blocks(bytes, [](std::size_t, std::size_t) {});
}

bool read_with_digest(const ReadOnlyFile& file, std::uint64_t offset, std::span<std::byte> bytes,
                      Digest& digest) {
  std::atomic<bool> complete = true;
  digest = digest_of_blocks(bytes, [&](std::size_t begin, std::size_t size) {
    if (!file.read(offset + begin, bytes.data() + begin, size)) complete = false;
  });
  return complete;
}

}  // namespace keepout
