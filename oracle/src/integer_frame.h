// SPDX-License-Identifier: BSD-3-Clause
// Internal: the only file that includes GMP.
#pragma once

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "keepout/geometry/shapes.h"

namespace keepout::oracle {

using Integer = mpz_class;
using IntegerVec = std::array<Integer, 3>;

inline IntegerVec operator-(const IntegerVec& a, const IntegerVec& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

inline Integer dot(const IntegerVec& a, const IntegerVec& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

inline IntegerVec cross(const IntegerVec& a, const IntegerVec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// value = digits * 2^exponent, with odd digits.
struct Binary {
  std::int64_t digits;
  int exponent;
};

inline Binary binary(double value) {
  int exponent = 0;
  const auto digits = static_cast<std::int64_t>(std::ldexp(std::frexp(value, &exponent), 53));
  const int zeros = std::countr_zero(static_cast<std::uint64_t>(digits));
  return {digits / (std::int64_t{1} << zeros), exponent - 53 + zeros};
}

/// A unit of length, a power of two, in which each included double is an integer.
class IntegerFrame {
 public:
  void include(double value) {
    if (value != 0.0) exponent_ = std::min(exponent_, binary(value).exponent);
  }
  void include(const Vec3& v) {
    for (int i = 0; i < 3; ++i) include(v[i]);
  }

  /// Returns the exact integer of a value. Precondition: `value` was included.
  Integer integer(double value) const {
    if (value == 0.0) return 0;
    const Binary b = binary(value);
    return Integer(static_cast<long>(b.digits))
           << static_cast<unsigned long>(b.exponent - exponent_);
  }
  IntegerVec integer(const Vec3& v) const { return {integer(v[0]), integer(v[1]), integer(v[2])}; }

  /// Returns the exponent: the unit is 2 to this power.
  int exponent() const noexcept { return exponent_; }

 private:
  int exponent_ = std::numeric_limits<int>::max();
};

}  // namespace keepout::oracle
