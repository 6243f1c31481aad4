// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/robot/denavit_hartenberg.h"

#include <Eigen/Geometry>
#include <cmath>
#include <string>

#include "keepout/error.h"

namespace keepout {
namespace {

/// Returns the pose after a turn by `angle` about an axis of the frame, and a displacement by `way`
/// along it.
Pose screw(const Vec3& axis, double angle, double way) {
  return {way * axis, Eigen::AngleAxisd(angle, axis).toRotationMatrix()};
}

}  // namespace

DhChain joints_of(std::span<const DenavitHartenberg> table, DhConvention convention) {
  DhChain chain;
  Pose before;  // the fixed transform from the previous joint to this row
  for (const DenavitHartenberg& row : table) {
    for (const double number : {row.a, row.alpha, row.d, row.theta}) {
      if (std::isfinite(number)) continue;
      throw Error("row " + std::to_string(chain.joints.size() + 1) +
                  " of the table has a number that is not finite");
    }
    const Pose about_x = screw(Vec3::UnitX(), row.alpha, row.a);
    const Pose about_z = screw(Vec3::UnitZ(), row.theta, row.d);
    const bool is_modified = convention == DhConvention::modified;
    chain.joints.push_back({.name = row.name,
                            .kind = row.kind,
                            .origin = is_modified ? about_x * about_z : before * about_z,
                            .limits = row.limits});
    before = is_modified ? Pose{} : about_x;
  }
  chain.flange = before;
  return chain;
}

}  // namespace keepout
