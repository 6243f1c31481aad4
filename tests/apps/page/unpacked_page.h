// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "keepout/mesh/mesh.h"

namespace keepout::test {

// Functions that unpack meshes as a page does.

inline std::vector<std::uint8_t> from_base64(std::string_view text) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t bits = 0;
  unsigned count = 0;
  for (const char c : text.substr(0, text.find('='))) {
    const std::size_t digit = digits.find(c);
    if (digit == std::string_view::npos) throw std::runtime_error("not base64");
    bits = bits << 6U | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::uint8_t>(bits >> count));
  }
  return bytes;
}

/// Returns the unpacked file. Throws if it is incomplete, or if bytes follow it.
inline std::vector<std::uint8_t> gunzipped(std::vector<std::uint8_t> file) {
  z_stream stream = {};
  if (inflateInit2(&stream, MAX_WBITS + 16) != Z_OK) throw std::runtime_error("no zlib");
  stream.next_in = file.data();
  stream.avail_in = static_cast<uInt>(file.size());
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint8_t> part(100'000);
  int state = Z_OK;
  while (state == Z_OK) {
    stream.next_out = part.data();
    stream.avail_out = static_cast<uInt>(part.size());
    state = inflate(&stream, Z_NO_FLUSH);
    bytes.insert(bytes.end(), part.data(), stream.next_out);
  }
  const bool whole = state == Z_STREAM_END && stream.avail_in == 0;
  inflateEnd(&stream);
  if (!whole) throw std::runtime_error("not a whole gzip file");
  return bytes;
}

/// Returns the number at an index of a sequence, with its lowest byte first.
template <class Bits>
Bits number_at(std::span<const std::uint8_t> bytes, std::size_t index) {
  Bits bits = 0;
  for (std::size_t i = sizeof bits; i-- > 0;) {
    bits = static_cast<Bits>(bits << 8U) | bytes[index * sizeof bits + i];
  }
  return bits;
}

inline Surface unpacked(std::string_view coordinates, std::span<const std::uint8_t> bytes,
                        std::size_t vertex_count, std::size_t triangle_count) {
  const std::size_t width = coordinates == "float32" ? 4 : 8;
  const std::size_t corner_count = 3 * triangle_count;
  if (bytes.size() != 3 * vertex_count * width + 4 * corner_count) {
    throw std::runtime_error("more bytes or fewer than the mesh has");
  }
  Surface surface{.vertices = std::vector<Vec3>(vertex_count),
                  .triangles = std::vector<Corners>(triangle_count)};
  for (std::size_t i = 0; i < 3 * vertex_count; ++i) {
    surface.vertices[i % vertex_count][static_cast<Eigen::Index>(i / vertex_count)] =
        width == 4 ? double{std::bit_cast<float>(number_at<std::uint32_t>(bytes, i))}
                   : std::bit_cast<double>(number_at<std::uint64_t>(bytes, i));
  }
  const std::span<const std::uint8_t> planes = bytes.subspan(3 * vertex_count * width);
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < corner_count; ++i) {
    std::uint32_t code = 0;
    for (std::size_t plane = 4; plane-- > 0;) code = code << 8U | planes[plane * corner_count + i];
    surface.triangles[i / 3][i % 3] = next - code;
    if (code == 0) ++next;
  }
  return surface;
}

/// Returns true if the two are bitwise identical: 0 and -0 differ.
inline bool same_bits(const Surface& surface, const Mesh& mesh) {
  if (surface.vertices.size() != mesh.vertex_count()) return false;
  if (!std::equal(surface.triangles.begin(), surface.triangles.end(), mesh.triangles().begin(),
                  mesh.triangles().end())) {
    return false;
  }
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    for (int axis = 0; axis < 3; ++axis) {
      if (std::bit_cast<std::uint64_t>(surface.vertices[v][axis]) !=
          std::bit_cast<std::uint64_t>(mesh.vertices()[v][axis])) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace keepout::test
