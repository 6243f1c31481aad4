// SPDX-License-Identifier: BSD-3-Clause
#include "plan/judge_joint_path.h"

#include <algorithm>
#include <cmath>

#include "keepout/robot/motion_bounds.h"

namespace keepout::app {
namespace {

constexpr double between_places =
    0.05;                             // a point's way from one that is looked at to the next [mm]
constexpr double piece_length = 1.0;  // of what is proven at once [mm]

using Positions = std::vector<double>;

Positions between(const Positions& from, const Positions& to, double share) {
  Positions q = from;
  for (std::size_t k = 0; k < q.size(); ++k) q[k] += share * (to[k] - from[k]);
  return share == 1.0 ? to : q;
}

Positions increment(const Positions& from, const Positions& to) {
  Positions dq = to;
  for (std::size_t k = 0; k < dq.size(); ++k) dq[k] -= from[k];
  return dq;
}

/// No point of a body goes farther. [mm]
double longest_way(const Instrument& instrument, const Positions& from, const Positions& to) {
  ChainState state;
  instrument.chain().forward_kinematics(from, state);
  double longest = 0.0;
  for (const LinkPoint& point : instrument.points()) {
    const Vec3 at = state.at(point.link, point.position);
    longest = std::max(longest, motion_bounds(state, increment(from, to), point.link, at).path);
  }
  return longest;
}

}  // namespace

JointPathVerdict judge_joint_path(oracle::InstrumentOracle& oracle, InstrumentConstraint& guard,
                                  std::span<const std::vector<double>> path) {
  JointPathVerdict verdict;
  const double margin = guard.options().margin;
  const double least = margin - guard.options().band - 3.0 * guard.tolerance();
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Positions &from = path[i - 1], &to = path[i];
    const double way = longest_way(guard.instrument(), from, to);
    const auto in_steps_of = [way](double length) {
      return std::max(1.0, std::ceil(way / length));
    };

    double clearance = std::numeric_limits<double>::infinity();
    const double places = in_steps_of(between_places);
    for (double k = 0.0; k <= places; k += 1.0) {
      oracle.move_to(between(from, to, k / places));
      clearance = std::min(clearance, oracle.clearance(margin));
    }
    bool is_proven = true;
    const double pieces = in_steps_of(piece_length);
    for (double k = 0.0; k < pieces && is_proven; k += 1.0) {
      const Positions start = between(from, to, k / pieces);
      const Positions end = between(from, to, (k + 1.0) / pieces);
      is_proven = guard.prove(start, increment(start, end)).is_clear();
    }
    ++verdict.motions;
    verdict.too_close += clearance < least ? 1 : 0;
    verdict.entering += clearance < 0.0 ? 1 : 0;
    verdict.unproven += is_proven ? 0 : 1;
    verdict.clearance = std::min(verdict.clearance, clearance);
  }
  return verdict;
}

}  // namespace keepout::app
