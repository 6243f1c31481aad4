// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "plan/path_verdict.h"

#include <algorithm>
#include <limits>

namespace keepout::app {

double least_distance(const Scene& scene, double margin, double radius) {
  // As verify/judge.cpp has it; the tip may be 10 mm beyond the mesh along each axis.
  const double lengths = scene.longest_edge() + radius * (1.0 + 1e-9) + margin;
  const double tau = 2e-10 * lengths + 4e-16 * (scene.farthest() + 30.0);
  return margin - 3.0 * tau;
}

PathVerdict judge_path(const Scene& scene, std::span<const Vec3> points, double least) {
  PathVerdict verdict;
  oracle::SafetyOracle oracle = scene.oracle();
  // No piece is farther off than its ends, so the search for the nearest need not reach farther.
  verdict.clearance = std::numeric_limits<double>::infinity();
  for (const Vec3& point : points) {
    verdict.clearance = std::min(verdict.clearance, oracle.distance(point));
  }
  for (std::size_t i = 1; i < points.size(); ++i) {
    const oracle::Finding finding =
        oracle.check(points[i - 1], points[i], least, verdict.clearance);
    verdict.clearance = std::min(verdict.clearance, finding.distance);
    verdict.enters |= finding.crosses;
    verdict.is_too_near |= finding.below;
    verdict.bad_pieces += finding.crosses || finding.below;
    verdict.length += (points[i] - points[i - 1]).norm();
  }
  return verdict;
}

}  // namespace keepout::app
