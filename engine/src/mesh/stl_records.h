// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "../read_only_file.h"

namespace keepout {

static_assert(std::endian::native == std::endian::little, "STL files are little-endian");

constexpr std::size_t stl_header_size = 80;

// A record is a normal, three corners and two bytes of attributes, without padding.
constexpr std::size_t stl_record_size = 50;

using StlCorners = std::array<float, 9>;

inline StlCorners stl_corners(const char* record) noexcept {
  constexpr std::size_t after_the_normal = 12;
  StlCorners corners;
  std::memcpy(corners.data(), record + after_the_normal, sizeof corners);
  return corners;
}

inline bool is_finite(const StlCorners& corners) noexcept {
  bool finite = true;
  for (const float x : corners) finite &= std::abs(x) <= std::numeric_limits<float>::max();
  return finite;
}

/// The triangles that the header of a binary STL file declares, if its length agrees.
std::optional<std::uint32_t> declared_triangles(const ReadOnlyFile& file);

/// The records of a binary STL file.
class StlRecords {
 public:
  /// Throws Error when it is not one, or has no triangles, or too many.
  explicit StlRecords(const std::filesystem::path& path);

  std::size_t count() const noexcept { return count_; }

  /// Reads `count` records from `first` on. Throws Error if they are not to be had.
  void read(std::size_t first, std::size_t count, std::vector<char>& records) const;

  /// Throws Error for a triangle with a coordinate that is not finite.
  [[noreturn]] void refuse(std::size_t triangle) const;

 private:
  [[noreturn]] void fail(const std::string& what) const;

  std::filesystem::path path_;
  ReadOnlyFile file_;
  std::size_t count_;
};

}  // namespace keepout
