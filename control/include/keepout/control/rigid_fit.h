// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "keepout/geometry/pose.h"
#include "keepout/geometry/shapes.h"

namespace keepout {

/// The rotation and translation that brings points measured by a robot onto those of a mesh, and
/// how well they fit. All lengths are in the unit of the mesh.
struct RigidFit {
  Pose mesh_from_robot;           // takes a measured point to the mesh [length]
  std::vector<double> residuals;  // of each pair, how far apart it is left [length]
  double fre = 0.0;               // fiducial registration error: sqrt(sum w r^2 / sum w) [length]
  double scale = 1.0;             // how much wider the model's points are spread than the measured
  std::string doubt;              // which mistake the residuals speak of; empty where of none
  Vec3 center = Vec3::Zero();     // weighted mean of the model's points [length]
  /// How much the points leave the rotation open: (sum w (|p|^2 I - p p^T))^-1 over the model's
  /// points, from the center, with weights of mean 1. [1 / length^2]
  Mat3 looseness = Mat3::Zero();

  /// The pose as Registration::mesh_from_robot takes it, with a `transform` in the mesh's unit.
  Eigen::Matrix4d matrix() const noexcept;

  /// The fiducial localisation error that the residuals let expect: how far off a pair is before
  /// the fit, root mean square, of both its points together; that of a pair of mean weight.
  /// FLE^2 = FRE^2 N / (N - 2), to first order (Fitzpatrick, West, Maurer 1998). [length]
  double estimated_fle() const noexcept;

  /// Returns why a fiducial localization error contradicts the residuals; empty if it does not.
  /// It does if fewer than one in a thousand registrations with that error, alike in all
  /// directions, has so large an FRE: N FRE^2 / (FLE^2 / 3) is chi-squared with 3 N - 6 degrees of
  /// freedom. fle: root mean square, above 0, as estimated_fle() [length]. Throws Error otherwise.
  std::string doubt_of(double fle) const;
};

/// The rigid fit, without a scale, of points measured in the robot's frame to the same ones in the
/// mesh's: it minimises sum w |R s + t - m|^2 (Horn 1987; by singular values, and never a
/// reflection: Umeyama 1991).
///
/// Both in the mesh's unit: what is measured in metres has to be multiplied by 1000 for a mesh in
/// millimetres. `weights`: one for each pair, or none for all alike; only their ratios count. They
/// are best proportional to 1 / (localisation error)^2 of the pair, and target_error takes them
/// for that.
///
/// Throws Error for fewer than 3 pairs, different counts, numbers that are not finite or beyond
/// longest_length, weights not above 0, points that coincide, points on a line (narrower than a
/// thousandth of its length), and pairs that are so mixed up that no rotation is best. Large
/// residuals are no error: see RigidFit::doubt.
RigidFit fit_rigid(std::span<const Vec3> measured, std::span<const Vec3> model,
                   std::span<const double> weights = {});

}  // namespace keepout
