// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/geometry/orientation.h"

#include <array>
#include <cmath>
#include <limits>

namespace keepout {
namespace {

// Shewchuk's bounds for the two tests below, with his epsilon: half a unit in the last place of 1.
constexpr double epsilon = std::numeric_limits<double>::epsilon() / 2.0;
constexpr double turn_bound = (3.0 + 16.0 * epsilon) * epsilon;
constexpr double side_bound = (7.0 + 56.0 * epsilon) * epsilon;

struct Pair {
  double high, low;  // high + low is the exact result, high the rounded one
};

Pair exact_sum(double a, double b) noexcept {
  const double sum = a + b;
  const double b_part = sum - a;
  return {sum, (a - (sum - b_part)) + (b - b_part)};
}

Pair exact_product(double a, double b) noexcept {
  const double product = a * b;
  return {product, std::fma(a, b, -product)};
}

/// A real number as an exact sum of at most N doubles that do not overlap, the smallest first.
template <int N>
struct Expansion {
  std::array<double, N> terms;
  int size = 0;

  /// Adds one double: Shewchuk's GROW-EXPANSION without zero terms.
  void add(double value) noexcept {
    int kept = 0;
    for (int i = 0; i < size; ++i) {
      const Pair sum = exact_sum(value, terms[i]);
      if (sum.low != 0.0) terms[kept++] = sum.low;
      value = sum.high;
    }
    if (value != 0.0) terms[kept++] = value;
    size = kept;
  }

  template <int M>
  void add_product(const Expansion<M>& other, double factor) noexcept {
    for (int i = 0; i < other.size; ++i) {
      const Pair product = exact_product(other.terms[i], factor);
      add(product.low);
      add(product.high);
    }
  }

  /// Returns the sign, which is that of the largest term: it exceeds the sum of all others.
  int sign() const noexcept {
    if (size == 0) return 0;
    return terms[size - 1] > 0.0 ? 1 : -1;
  }
};

Expansion<2> exact_difference(double a, double b) noexcept {
  Expansion<2> difference;
  const Pair pair = exact_sum(a, -b);
  difference.add(pair.low);
  difference.add(pair.high);
  return difference;
}

template <int N, int A, int B>
void add_product(Expansion<N>& sum, const Expansion<A>& a, const Expansion<B>& b,
                 double sign) noexcept {
  for (int i = 0; i < b.size; ++i) sum.add_product(a, sign * b.terms[i]);
}

constexpr int sign_of(double value) noexcept { return value > 0.0 ? 1 : value < 0.0 ? -1 : 0; }

int exact_turn(const Vec3& a, const Vec3& b, const Vec3& c, int x, int y) noexcept {
  Expansion<16> sum;
  add_product(sum, exact_difference(a[x], c[x]), exact_difference(b[y], c[y]), 1.0);
  add_product(sum, exact_difference(a[y], c[y]), exact_difference(b[x], c[x]), -1.0);
  return sum.sign();
}

int exact_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) noexcept {
  std::array<std::array<Expansion<2>, 3>, 3> from_d;
  for (int i = 0; i < 3; ++i) {
    from_d[0][i] = exact_difference(a[i], d[i]);
    from_d[1][i] = exact_difference(b[i], d[i]);
    from_d[2][i] = exact_difference(c[i], d[i]);
  }
  Expansion<192> sum;
  for (int i = 0; i < 3; ++i) {
    const auto& [one, two, three] = from_d;
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    Expansion<16> minor;
    add_product(minor, two[j], three[k], 1.0);
    add_product(minor, two[k], three[j], -1.0);
    add_product(sum, minor, one[i], -1.0);
  }
  return sum.sign();
}

}  // namespace

int turn(const Vec3& a, const Vec3& b, const Vec3& c, int axis) noexcept {
  const int x = (axis + 1) % 3;
  const int y = (axis + 2) % 3;
  const double left = (a[x] - c[x]) * (b[y] - c[y]);
  const double right = (a[y] - c[y]) * (b[x] - c[x]);
  const double difference = left - right;
  if (std::abs(difference) > turn_bound * (std::abs(left) + std::abs(right))) {
    return sign_of(difference);
  }
  if (left == 0.0 && right == 0.0) return 0;
  return exact_turn(a, b, c, x, y);
}

int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) noexcept {
  const Vec3 one = a - d;
  const Vec3 two = b - d;
  const Vec3 three = c - d;
  double sum = 0.0;
  double magnitude = 0.0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    const double left = two[j] * three[k];
    const double right = two[k] * three[j];
    sum += one[i] * (left - right);
    magnitude += std::abs(one[i]) * (std::abs(left) + std::abs(right));
  }
  // Seen from d, the corners of a plane below it turn the other way, hence the minus.
  if (std::abs(sum) > side_bound * magnitude) return sign_of(-sum);
  if (magnitude == 0.0) return 0;
  return exact_side(a, b, c, d);
}

int axis_of_sight(const Triangle& triangle) noexcept {
  for (int axis = 0; axis < 3; ++axis) {
    if (turn(triangle[0], triangle[1], triangle[2], axis) != 0) return axis;
  }
  return -1;
}

}  // namespace keepout
