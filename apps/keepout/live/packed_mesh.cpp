// SPDX-License-Identifier: BSD-3-Clause
#include "live/packed_mesh.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <new>

namespace keepout::app {
namespace {

/// No coordinate of a mesh is beyond what floats reach.
bool is_float(double number) { return static_cast<double>(static_cast<float>(number)) == number; }

/// The lowest byte first, whatever the order on this machine.
template <class Bits>
void append(std::vector<std::uint8_t>& bytes, Bits bits) {
  for (unsigned shift = 0; shift < 8 * sizeof bits; shift += 8) {
    bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
  }
}

std::vector<std::uint32_t> corner_codes(const Mesh& mesh) {
  std::vector<std::uint32_t> codes;
  codes.reserve(3 * mesh.triangle_count());
  std::uint32_t next = 0;
  for (const Corners& corners : mesh.triangles()) {
    for (const VertexId corner : corners) {
      codes.push_back(next - corner);
      if (corner == next) ++next;
    }
  }
  return codes;
}

}  // namespace

PackedMesh packed(const Mesh& mesh) {
  const bool floats = std::ranges::all_of(mesh.vertices(), [](const Vec3& v) {
    return is_float(v.x()) && is_float(v.y()) && is_float(v.z());
  });
  PackedMesh result{.coordinates = floats ? "float32" : "float64", .bytes = {}};
  result.bytes.reserve(3 * (floats ? sizeof(float) : sizeof(double)) * mesh.vertex_count() +
                       3 * sizeof(std::uint32_t) * mesh.triangle_count());
  for (int axis = 0; axis < 3; ++axis) {
    for (const Vec3& vertex : mesh.vertices()) {
      if (floats) {
        append(result.bytes, std::bit_cast<std::uint32_t>(static_cast<float>(vertex[axis])));
      } else {
        append(result.bytes, std::bit_cast<std::uint64_t>(vertex[axis]));
      }
    }
  }
  const std::vector<std::uint32_t> codes = corner_codes(mesh);
  for (unsigned shift = 0; shift < 32; shift += 8) {
    for (const std::uint32_t code : codes) {
      result.bytes.push_back(static_cast<std::uint8_t>(code >> shift));
    }
  }
  return result;
}

std::vector<std::uint8_t> gzipped(std::span<const std::uint8_t> bytes) {
  z_stream stream = {};
  constexpr int as_gzip = 16;  // added to the window's bits
  constexpr int default_memory = 8;
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, MAX_WBITS + as_gzip, default_memory,
                   Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::bad_alloc();  // nothing else can be wrong
  }
  std::vector<std::uint8_t> result;
  std::vector<std::uint8_t> part(std::size_t{1} << 16);
  stream.next_in = const_cast<Bytef*>(bytes.data());  // of which it only reads
  std::size_t left = bytes.size();
  do {
    const std::size_t fed =
        std::min<std::size_t>(left, std::size_t{1} << 30);  // its counts have 32 bits
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
