// SPDX-License-Identifier: BSD-3-Clause
#include "distance_field_rule.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "nearest_motion.h"

namespace keepout::peers {
namespace {

class DistanceFieldRule : public Rule {
 public:
  DistanceFieldRule(const Task& task, std::shared_ptr<DistanceField> field, FieldUse use)
      : corridor_(task.corridor),
        margin_(task.margin + (use == FieldUse::sure ? field->error_bound() : 0.0)),
        cuts_(use != FieldUse::plane),
        field_(std::move(field)) {}

  Vec3 step(const Vec3& tip, const Vec3& desired) override {
    constexpr int turns = 4;
    const double least = std::min(margin_, field_(tip).distance) - rounding;
    Vec3 place = tip, rest = desired;
    for (int turn = 0; turn < turns; ++turn) {
      const Vec3 motion = within_plane(place, rest);
      if (!cuts_) return motion;
      const double fraction = free_fraction(place, motion, least);
      Vec3 end = place + fraction * motion;
      if (turn > 0) {  // the tip moves straight to the end, not around the turn
        end = tip + free_fraction(tip, end - tip, least) * (end - tip);
        if ((end - tip - desired).norm() >= (place - tip - desired).norm()) break;
      }
      place = end;
      rest = (1.0 - fraction) * motion;
      if (fraction == 1.0 || rest.norm() < rounding) break;
    }
    return place - tip;
  }

 private:
  static constexpr double rounding = 1e-9;  // of the field's values [mm]

  /// Returns the motion within the plane of the field and the corridor.
  Vec3 within_plane(const Vec3& place, const Vec3& desired) {
    planes_.begin(corridor_, place);
    const auto [distance, gradient] = field_(place);
    const double steep = gradient.norm();
    if (steep > 0.0) {  // a flat field gives no direction
      planes_.add(gradient / steep, -std::max(distance - margin_, -recovery));
    }
    return planes_.to(desired);
  }

  /// Returns the fraction of a motion on which the field stays at `least` or above.
  double free_fraction(const Vec3& from, const Vec3& motion, double least) {
    constexpr double steepest = 1.7320509;  // each of three partial derivatives is at most 1
    if (field_(from).distance - steepest * motion.norm() >= least) return 1.0;
    double begin = 0.0;
    while (begin < 1.0) {
      const double end = end_of_cube(from, motion, begin);
      const double free = free_until(cubic(from, motion, begin, end), begin, end, least);
      if (free < end) return free;
      begin = end;
    }
    return 1.0;
  }

  /// Returns where the motion leaves the cube that it is in after the fraction `begin`; at most 1.
  double end_of_cube(const Vec3& from, const Vec3& motion, double begin) const {
    const double cell = field_.field().cell();
    double end = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      if (motion[axis] == 0.0) continue;
      const double at = (from[axis] + begin * motion[axis]) / cell;
      const double side = motion[axis] > 0.0 ? std::floor(at) + 1.0 : std::ceil(at) - 1.0;
      end = std::min(end, (side * cell - from[axis]) / motion[axis]);
    }
    return std::max(end, std::nextafter(begin, 2.0));
  }

  /// The control points, in Bernstein's basis, of the field along a part of a motion in one cube.
  /// The field is nowhere below the least of them.
  using Cubic = std::array<double, 4>;

  /// Returns the field between two fractions of a motion, where it is one polynomial of degree
  /// three.
  Cubic cubic(const Vec3& from, const Vec3& motion, double begin, double end) {
    const auto at = [&](double t) {
      return field_(from + (begin + t * (end - begin)) * motion).distance;
    };
    const double a = at(0.0), b = at(1.0 / 3.0), c = at(2.0 / 3.0), d = at(1.0);
    return {a, (-5.0 * a + 18.0 * b - 9.0 * c + 2.0 * d) / 6.0,
            (2.0 * a - 9.0 * b + 18.0 * c - 5.0 * d) / 6.0, d};
  }

  /// Returns the fraction between `begin` and `end` up to which a polynomial is proved to stay at
  /// `least` or above.
  static double free_until(const Cubic& p, double begin, double end, double least,
                           int halvings = 12) {
    if (std::min({p[0], p[1], p[2], p[3]}) >= least) return end;
    if (halvings == 0 || p[0] < least) return begin;
    // De Casteljau's halves.
    const auto mean = [](double a, double b) { return 0.5 * (a + b); };
    const double a = mean(p[0], p[1]), b = mean(p[1], p[2]), c = mean(p[2], p[3]);
    const double ab = mean(a, b), bc = mean(b, c), half = mean(ab, bc);
    const double middle = mean(begin, end);
    const double free = free_until({p[0], a, ab, half}, begin, middle, least, halvings - 1);
    if (free < middle) return free;
    return free_until({half, bc, c, p[3]}, middle, end, least, halvings - 1);
  }

  std::optional<Corridor> corridor_;
  double margin_;
  bool cuts_;
  DistanceField::Reader field_;
  NearestMotion planes_;
};

}  // namespace

std::unique_ptr<Rule> distance_field_rule(const Task& task, std::shared_ptr<DistanceField> field,
                                          FieldUse use) {
  return std::make_unique<DistanceFieldRule>(task, std::move(field), use);
}

}  // namespace keepout::peers
