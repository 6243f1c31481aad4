// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
// Internal: the only place where GMP comes in.
#pragma once

#include <gmpxx.h>

#include <array>
#include <limits>

#include "keepout/geometry/vec3.h"

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

/// A unit of length, a power of two, in which each of the included doubles is a whole number.
class IntegerFrame {
 public:
  void include(double value);
  void include(const Vec3& v) {
    for (int i = 0; i < 3; ++i) include(v[i]);
  }

  /// Exact. Precondition: `value` was included.
  Integer integer(double value) const;
  IntegerVec integer(const Vec3& v) const { return {integer(v[0]), integer(v[1]), integer(v[2])}; }

  /// The unit is 2 to this power.
  int exponent() const noexcept { return exponent_; }

 private:
  int exponent_ = std::numeric_limits<int>::max();
};

}  // namespace keepout::oracle
