// SPDX-License-Identifier: BSD-3-Clause
// An arm of seven joints that moves the tip: keepout returns the increments of the joints. With
// more than three joints, many increments move the tip in the same way; damping above 0 selects the
// smallest.
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>

#include "keepout/keepout.h"

namespace {

using Joints = Eigen::Matrix<double, 7, 1>;    // [rad]
using Jacobian = Eigen::Matrix<double, 6, 7>;  // translation of the tip above, rotation below

/// Joints that turn about x and y alternately, 60 mm apart.
class Arm {
 public:
  /// The position of the tip from the arm's base, and the Jacobian.
  keepout::Vec3 tip(const Joints& q, Jacobian& jacobian) const {
    Eigen::Matrix3d turned = Eigen::Matrix3d::Identity();
    keepout::Vec3 at = keepout::Vec3::Zero();
    Eigen::Matrix<double, 3, 7> joint, axis;
    for (int i = 0; i < 7; ++i) {
      const keepout::Vec3 about = i % 2 == 0 ? keepout::Vec3::UnitX() : keepout::Vec3::UnitY();
      joint.col(i) = at;
      axis.col(i) = turned * about;
      turned *= Eigen::AngleAxisd(q[i], about).toRotationMatrix();
      at += turned * keepout::Vec3(0, 0, -60);
    }
    for (int i = 0; i < 7; ++i) {
      jacobian.col(i) << axis.col(i).cross(at - joint.col(i)), axis.col(i);
    }
    return at;
  }
};

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s MESH\n", argv[0]);
    return 2;
  }
  const auto mesh = keepout::load_mesh(argv[1]).mesh;
  auto guard = keepout::make_motion_constraint(
      mesh, {.options = {.tool_radius = 0.3,
                         .margin = 0.2,
                         .damping = 1e-2,  // for columns of 60 mm/rad and more
                         .distances = keepout::Distances::always}});

  const Arm arm;
  Joints q(0.5, 0.3, -0.8, 0.4, 0.9, -0.3, 0.2);
  Jacobian jacobian;
  // The tip starts 5 mm above the mesh; the commanded motion goes straight through the mesh.
  const keepout::Box& box = mesh->bounds();
  const keepout::Vec3 start(box.center().x(), box.center().y(), box.high.z() + 5.0);
  const keepout::Vec3 base = start - arm.tip(q, jacobian);
  const keepout::Vec3 goal(start.x(), start.y(), box.low.z());
  keepout::Vec3 tip = start;
  double nearest = 5.0;
  int held = 0;
  for (int cycle = 0; cycle < 2000; ++cycle) {
    const keepout::Step step = guard.step({.tip = tip,
                                           .desired = 0.2 * (goal - tip).normalized(),
                                           .jacobian = jacobian.topRows<3>()});
    if (!step.ok()) std::printf("cycle %d: %s\n", cycle, step.reason().data());
    held += step.status != keepout::Status::free;
    nearest = std::min(nearest, step.distance.value_or(nearest));
    if (step.ok()) q += Joints(step.increment.data());
    tip = base + arm.tip(q, jacobian);
  }
  std::printf("held back in %d of 2000 cycles, nearest %.4f mm, ends at %.6f %.6f %.6f\n", held,
              nearest, tip.x(), tip.y(), tip.z());
  return 0;
} catch (const keepout::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
