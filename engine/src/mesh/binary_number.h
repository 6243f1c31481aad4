// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace keepout {

/// A type of the numbers in a file.
struct NumberType {
  std::size_t size;  // [bytes]
  bool whole;        // an integer, not a floating-point number
  bool is_signed;
};

/// Returns the number at `bytes`. `swapped`: in the byte order of another machine.
template <class T>
T number_at(const char* bytes, bool swapped) noexcept {
  char ordered[sizeof(T)];
  std::memcpy(ordered, bytes, sizeof(T));
  if (swapped) std::reverse(ordered, ordered + sizeof(T));
  return std::bit_cast<T>(ordered);
}

/// Like number_at(), for an integer. An unsigned one of 64 bits that is too large for the result
/// becomes negative.
inline std::int64_t whole_at(const char* bytes, const NumberType& type, bool swapped) noexcept {
  switch (type.size) {
    case 1:
      return type.is_signed ? std::int64_t{number_at<std::int8_t>(bytes, swapped)}
                            : number_at<std::uint8_t>(bytes, swapped);
    case 2:
      return type.is_signed ? std::int64_t{number_at<std::int16_t>(bytes, swapped)}
                            : number_at<std::uint16_t>(bytes, swapped);
    case 4:
      return type.is_signed ? std::int64_t{number_at<std::int32_t>(bytes, swapped)}
                            : number_at<std::uint32_t>(bytes, swapped);
    default:
      return number_at<std::int64_t>(bytes, swapped);
  }
}

/// Like number_at(), for a number of any type.
inline double real_at(const char* bytes, const NumberType& type, bool swapped) noexcept {
  if (type.whole) return static_cast<double>(whole_at(bytes, type, swapped));
  return type.size == sizeof(float) ? double{number_at<float>(bytes, swapped)}
                                    : number_at<double>(bytes, swapped);
}

}  // namespace keepout
