// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/oracle/judged_guide.h"

#include <algorithm>
#include <cmath>

namespace keepout::oracle {
namespace {

using Real = LinkFrame::Real;
using Vector = Eigen::Matrix<Real, 3, 1>;

Vector at(const JudgedPoint& point, std::span<const LinkFrame> links) {
  const LinkFrame& link = links[static_cast<std::size_t>(point.link)];
  return link.origin + link.axes * point.position.cast<Real>();
}

/// Returns the fraction of the segment at which the guided point of a remote center is.
Real fraction(const JudgedGuide& guide, std::span<const LinkFrame> links) {
  const Vector from = at(guide.first, links);
  const Vector along = at(guide.second, links) - from;
  const Real squared = along.squaredNorm();
  if (!(squared > 0)) return 0;
  return std::clamp(along.dot(guide.origin.cast<Real>() - from) / squared, Real{0}, Real{1});
}

Vector guided(const JudgedGuide& guide, std::span<const LinkFrame> links) {
  if (guide.kind == JudgedGuide::Kind::axis) {
    return links[static_cast<std::size_t>(guide.first.link)].axes *
           guide.first.position.cast<Real>();
  }
  const Vector from = at(guide.first, links);
  if (guide.kind == JudgedGuide::Kind::point) return from;
  return from + fraction(guide, links) * (at(guide.second, links) - from);
}

/// Bisects the motion of a guide.
class GuideCheck {
 public:
  GuideCheck(const JudgedGuide& guide, const JudgedRobot& robot, const Pose& base,
             const InstrumentMotion& motion, double most)
      : guide_(guide), robot_(robot), base_(base), motion_(motion), most_(most) {}

  MotionFinding check() {
    const State start = state(0.0);
    const std::vector<LinkFrame> before = links_;
    const State end = state(1.0);
    bound(before);
    if (end.excess > most_ || start.excess > most_) {
      return {Clearance::lost, 0, end.excess > most_ ? 1.0 : 0.0};
    }
    return check_part(start, end, 0);
  }

 private:
  struct State {
    double s;
    double excess;
    double fraction;
  };

  State state(double s) {
    std::vector<double> positions(motion_.from.begin(), motion_.from.end());
    for (std::size_t k = 0; k < positions.size(); ++k) {
      positions[k] = s == 1.0 ? motion_.to[k] : positions[k] + s * (motion_.to[k] - positions[k]);
    }
    links_ = place(robot_, base_, positions);
    const bool has_fraction = guide_.kind == JudgedGuide::Kind::remote_center;
    return {s, excess(guide_, links_),
            has_fraction ? static_cast<double>(fraction(guide_, links_)) : 0.0};
  }

  /// Bounds the motion of the guided points from the links at the start to those at the end.
  void bound(std::span<const LinkFrame> before) {
    std::vector<JointLine> start, end;
    double turn = 0.0;
    for (std::size_t k = 0; k < robot_.table.size(); ++k) {
      const double change = motion_.to[k] - motion_.from[k];
      start.push_back(joint_line(robot_.table[k], before[k + 1], change));
      end.push_back(joint_line(robot_.table[k], links_[k + 1], change));
      const bool turns = !robot_.table[k].slides && static_cast<int>(k) < guide_.first.link;
      turn += turns ? std::abs(change) : 0.0;
    }
    const auto of = [&](const JudgedPoint& point) {
      const auto link = static_cast<std::size_t>(point.link);
      return travel(std::span(start).first(link), std::span(end).first(link),
                    before[link].at(point.position), links_[link].at(point.position));
    };
    if (guide_.kind == JudgedGuide::Kind::axis) {
      const double length = guide_.first.position.norm() * (1.0 + 1e-13);
      travel_ = {turn * length, turn * turn * length};
      return;
    }
    travel_ = of(guide_.first);
    if (guide_.kind == JudgedGuide::Kind::point) return;
    const Travel second = of(guide_.second);
    sum_of_speeds_ = travel_.speed + second.speed;
    travel_ = {std::max(travel_.speed, second.speed), std::max(travel_.bend, second.bend)};
  }

  MotionFinding check_part(const State& a, const State& b, int level) {
    const double width = b.s - a.s;
    if (0.5 * (a.excess + b.excess + travel_.speed * width) <= most_) return {};
    const double along = 2.0 * std::abs(b.fraction - a.fraction) * width * sum_of_speeds_;
    const double bend = travel_.bend * width * width + along;
    if (-least_between(-a.excess, -b.excess, bend) <= most_) return {};
    if (level == MotionCheck::levels) return {Clearance::undecided};
    const State middle = state(0.5 * (a.s + b.s));
    if (middle.excess > most_) return {Clearance::lost, 0, middle.s};
    const MotionFinding before = check_part(a, middle, level + 1);
    return before.clearance == Clearance::kept ? check_part(middle, b, level + 1) : before;
  }

  const JudgedGuide& guide_;
  const JudgedRobot& robot_;
  const Pose& base_;
  const InstrumentMotion& motion_;
  double most_;
  Travel travel_ = {};
  double sum_of_speeds_ = 0.0;
  std::vector<LinkFrame> links_ = {};
};

}  // namespace

double excess(const JudgedGuide& guide, std::span<const LinkFrame> links) {
  const Vector offset = guided(guide, links) - guide.origin.cast<Real>();
  const Vector direction = guide.direction.cast<Real>();
  const Real along = offset.dot(direction);
  Real out = 0;
  switch (guide.region) {
    case JudgedGuide::Region::half_space:
      out = -along;
      break;
    case JudgedGuide::Region::slab:
      out = along < 0 ? -along : along;
      break;
    case JudgedGuide::Region::tube:
      out = (offset - along * direction).norm();
      break;
    case JudgedGuide::Region::ball:
      out = offset.norm();
      break;
  }
  return static_cast<double>(out - guide.radius);
}

MotionFinding check_guide(const JudgedGuide& guide, const JudgedRobot& robot, const Pose& base,
                          const InstrumentMotion& motion, double most) {
  return GuideCheck(guide, robot, base, motion, most).check();
}

}  // namespace keepout::oracle
