// SPDX-License-Identifier: BSD-3-Clause
//
// Why floats may decide. Let u = 2^-24 be the rounding of a float, c the ball's center and r its
// radius. Let E be the error of the floats' coordinates, and M the distance from c to a triangle's
// farthest corner.
//
// 1. A corner relative to the center is p = (v - high) - low. Both subtractions round by u of their
//    results, and high + low is c to u^2 |c|. So p is off by at most
//        2.1 u |p| + A,    A = sqrt(3) (E + 2.1 u^2 |c|).
//    The triangle's distance is off by no more than its corners. The exact kernel is in double: its
//    error, and that of c - high, is below u M / 1000. If the floats have an origin of their own, c
//    is relative to it, exact to 2^-53 |c|: a fraction of 2^-5 of that part of A.
// 2. Surely in: a point q of the triangle, computed to 8 u M, is so near that
//        |q| + 10.2 u M <= r - A.  With R = r - A and 2 M R <= M^2 + R^2 it suffices that
//        |q|^2 + 10.2 u (M^2 + R^2) <= R^2.
// 3. Surely out: for any q, no point of the triangle is nearer than min q.p / |q| over the corners.
//    The product is off by 3.1 u |q| M. With R = r + A it suffices that min q.p > 0 and
//        (min q.p)^2 > |q|^2 (R^2 + 6 u (M^2 + R^2)).
//    A poor q, such as that of a needle, may miss the proof, but never makes it wrong.
// 4. The tests themselves round by less than 12 u of M^2 + R^2, or of |q|^2 times it.
//
// So both tests have a band of 32 u. The exact kernel decides results in the band, and NaN.
// Separate bounds exclude products that are too small for a float to keep its digits. Products that
// are too large become infinite, and then prove nothing.
//
// Boxes are rounded outward. The distance of a box from the center, rounded to either side, is off
// only by the rounding of three differences, their squares and their sum. The radius is enlarged by
// the kernel's error, which is relative to the distance to the far end of the mesh.
#include "ball_screen.h"

#include <algorithm>
#include <cmath>

namespace keepout {
namespace {

// Beyond these limits, squares in float might overflow in a test that decides.
constexpr double largest_radius = 1e18;
constexpr double largest_coordinate = 1e30;

constexpr double kernel_rounding = 1e-13;
constexpr double split_rounding = 0x1p-46;
constexpr double sqrt_3 = 1.7320508075688774;
constexpr double box_rounding = 0x1p-19;

}  // namespace

BallScreen::BallScreen(const Ball& whole, const Box& bounds, const LeafFrame& frame) noexcept
    : ball(whole) {
  const Vec3 center = whole.center - frame.origin;
  const double farthest = center.cwiseAbs().sum();
  pad = kernel_rounding * (whole.radius + (whole.center - bounds.low).cwiseAbs().sum() +
                           (bounds.high - bounds.low).sum());
  const double reach = std::max(whole.radius, 0.0) + pad;
  fits = farthest < largest_coordinate && reach < largest_radius;  // false for NaN
  if (!fits) return;

  for (int axis = 0; axis < 3; ++axis) {
    const double x = center[axis];
    high_part[axis] = static_cast<float>(x);
    low_part[axis] = static_cast<float>(x - static_cast<double>(high_part[axis]));
    below[axis] = at_most(x);
    above[axis] = at_least(x);
  }

  off = sqrt_3 * (frame.error + split_rounding * farthest);
  const double in = whole.radius - off;
  const double out = std::max(whole.radius + off, 0.0);
  inside2 = in > 0.0 ? at_most(in * in) : -1.0f;
  outside2 = at_least(out * out);

  const double core = whole.radius - pad;
  box_reach2 = at_least(reach * reach * (1.0 + box_rounding));
  box_inside2 = core > 0.0 ? at_most(core * core * (1.0 - box_rounding)) : -1.0f;
}

}  // namespace keepout
