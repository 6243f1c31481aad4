// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/oracle/inside_test.h"

#include <cstddef>
#include <random>
#include <utility>
#include <vector>

#include "integer_frame.h"
#include "keepout/monitor/inside.h"

namespace keepout::oracle {
namespace {

int exact_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  IntegerFrame frame;
  for (const Vec3& v : {a, b, c, d}) frame.include(v);
  const IntegerVec apex = frame.integer(a);
  return sgn(dot(frame.integer(b) - apex, cross(frame.integer(c) - apex, frame.integer(d) - apex)));
}

}  // namespace

int volume_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const std::optional<int> sign = monitor::volume_sign(a, b, c, d);
  return sign ? *sign : exact_sign(a, b, c, d);
}

InsideTest::InsideTest(std::shared_ptr<const TriangleTree> tree)
    : tree_(std::move(tree)), closed_(is_closed(tree_->mesh())) {}

std::optional<bool> InsideTest::inside(const Vec3& point) const {
  if (!closed_) return std::nullopt;
  const Bounds bounds = tree_->bounds();
  if (!bounds.contains({point, point})) return false;

  std::mt19937_64 random(20261120);
  std::uniform_real_distribution<double> share(0.25, 1.0);
  std::vector<TriangleId> near;
  while (true) {
    Vec3 factors;
    for (double& factor : factors) factor = (random() % 2 == 0 ? 1.0 : -1.0) * share(random);
    const Vec3 to = beyond(*tree_, point, factors);
    near.clear();
    tree_->collect_along({point, to}, near);
    bool odd = false;
    bool clear = true;
    for (const TriangleId t : near) {
      const Triangle triangle = tree_->mesh().triangle(t);
      const Piercing found = piercing({point, to}, triangle, &volume_sign);
      if (found == Piercing::yes) odd = !odd;
      if (found != Piercing::unclear) continue;
      if (exact_distance({point, point}, triangle, 0.0).against_zero == 0) return false;
      clear = false;
    }
    if (clear) return odd;
  }
}

}  // namespace keepout::oracle
