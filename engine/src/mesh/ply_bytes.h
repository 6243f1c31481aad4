// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "keepout/mesh/ply_header.h"

namespace keepout {

/// Bytes as they stand in a binary PLY file, into numbers.
class PlyBytes {
 public:
  explicit PlyBytes(PlyEncoding encoding) noexcept
      : swapped_((encoding == PlyEncoding::big_endian) !=
                 (std::endian::native == std::endian::big)) {}

  double real(const char* bytes, const PlyScalar& type) const noexcept {
    if (type.whole) return static_cast<double>(whole(bytes, type));
    return type.size == 4 ? double{get<float>(bytes)} : get<double>(bytes);
  }

  std::int64_t whole(const char* bytes, const PlyScalar& type) const noexcept {
    switch (type.size) {
      case 1:
        return type.is_signed ? std::int64_t{get<std::int8_t>(bytes)} : get<std::uint8_t>(bytes);
      case 2:
        return type.is_signed ? std::int64_t{get<std::int16_t>(bytes)} : get<std::uint16_t>(bytes);
      default:
        return type.is_signed ? std::int64_t{get<std::int32_t>(bytes)} : get<std::uint32_t>(bytes);
    }
  }

 private:
  template <class T>
  T get(const char* bytes) const noexcept {
    char ordered[sizeof(T)];
    std::memcpy(ordered, bytes, sizeof(T));
    if (swapped_) std::reverse(ordered, ordered + sizeof(T));
    T value;
    std::memcpy(&value, ordered, sizeof(T));
    return value;
  }

  bool swapped_;
};

}  // namespace keepout
