// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause

#include "keepout/oracle/volume_sign.h"

#include <cmath>

#include "integer_frame.h"

namespace keepout::oracle {
namespace {

// Six products of three differences, each difference off by u = 2^-53, two more roundings in the
// products, one of the inner difference and two of the sums: 8 u relative to the sum of the
// products' magnitudes. 16 u leaves room for the terms in u^2 and for the magnitude being rounded
// itself; underflow (some 2^-1074 times a factor below 1e30) is far below 16 u times the least
// magnitude.
constexpr double rounding = 0x1p-49;
constexpr double least_magnitude = 1e-250;
constexpr double largest_factor = 1e30;

int exact_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  IntegerFrame frame;
  for (const Vec3& v : {a, b, c, d}) frame.include(v);
  const IntegerVec apex = frame.integer(a);
  return sgn(dot(frame.integer(b) - apex, cross(frame.integer(c) - apex, frame.integer(d) - apex)));
}

}  // namespace

int volume_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 p = b - a;
  const Vec3 q = c - a;
  const Vec3 r = d - a;
  double sum = 0.0;
  double magnitude = 0.0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    const double left = q[j] * r[k];
    const double right = q[k] * r[j];
    sum += p[i] * (left - right);
    magnitude += std::abs(p[i]) * (std::abs(left) + std::abs(right));
  }
  const bool in_range =
      magnitude >= least_magnitude && p.lpNorm<Eigen::Infinity>() < largest_factor;
  if (in_range && std::abs(sum) > rounding * magnitude) return sum > 0.0 ? 1 : -1;
  return exact_sign(a, b, c, d);
}

}  // namespace keepout::oracle
