// SPDX-License-Identifier: BSD-3-Clause
#include "page/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <cstddef>
#include <new>

namespace keepout::app {

std::vector<std::uint8_t> gzipped(std::span<const std::uint8_t> bytes) {
  z_stream stream = {};
  constexpr int as_gzip = 16;  // added to the window bits
  constexpr int default_memory = 8;
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, MAX_WBITS + as_gzip, default_memory,
                   Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::bad_alloc();  // the only possible error
  }
  std::vector<std::uint8_t> result;
  std::vector<std::uint8_t> part(std::size_t{1} << 16);
  stream.next_in = const_cast<Bytef*>(bytes.data());  // zlib only reads it
  std::size_t left = bytes.size();
  do {
    const std::size_t fed =
        std::min<std::size_t>(left, std::size_t{1} << 30);  // zlib counts with 32 bits
    stream.avail_in = static_cast<uInt>(fed);
    left -= fed;
    do {
      stream.next_out = part.data();
      stream.avail_out = static_cast<uInt>(part.size());
      deflate(&stream, left == 0 ? Z_FINISH : Z_NO_FLUSH);
      result.insert(result.end(), part.data(), stream.next_out);
    } while (stream.avail_out == 0);
  } while (left > 0);
  deflateEnd(&stream);
  return result;
}

}  // namespace keepout::app
