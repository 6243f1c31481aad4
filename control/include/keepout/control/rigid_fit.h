// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "keepout/geometry/pose.h"
#include "keepout/geometry/shapes.h"

namespace keepout {

/// The rigid transform from points measured by a robot to points of a mesh, and the quality of the
/// fit. All lengths are in the unit of the mesh.
struct RigidFit {
  Pose mesh_from_robot;           // transforms a measured point into the mesh's frame [length]
  std::vector<double> residuals;  // the remaining distance of each pair [length]
  double fre = 0.0;               // fiducial registration error: sqrt(sum w r^2 / sum w) [length]
  double scale = 1.0;  // spread of the model's points divided by that of the measured points
  std::string doubt;   // the mistake that the residuals suggest; empty if they suggest no mistake
  Vec3 center = Vec3::Zero();  // weighted mean of the model's points [length]
  /// The uncertainty of the rotation: (sum w (|p|^2 I - p p^T))^-1 over the model's points p
  /// relative to the center, with weights of mean 1. [1 / length^2]
  Mat3 looseness = Mat3::Zero();

  /// Returns the matrix for Registration::mesh_from_robot, with RegistrationUnits::transform in the
  /// mesh's unit.
  Eigen::Matrix4d matrix() const noexcept;

  /// Returns the fiducial localization error (FLE) estimated from the residuals: the root mean
  /// square error of a pair of mean weight, with the errors of both points. To first order, FLE^2 =
  /// FRE^2 N / (N - 2) (Fitzpatrick, West, Maurer 1998). [length]
  double estimated_fle() const noexcept;

  /// Returns why a fiducial localization error contradicts the residuals; empty if it does not. A
  /// contradiction means that fewer than one in a thousand registrations with that error have so
  /// large an FRE. The error is assumed equal in all directions. N FRE^2 / (FLE^2 / 3) is
  /// chi-squared with 3 N - 6 degrees of freedom. `fle`: root mean square, above 0, like
  /// estimated_fle() [length]. Throws Error for a number that is not above 0 or not finite.
  std::string doubt_of(double fle) const;
};

/// Returns the rigid transform, without a scale, from points s measured in the robot's frame to the
/// same points m in the mesh's frame. It minimizes sum w |R s + t - m|^2 (Horn 1987). The method
/// uses singular values and excludes reflections (Umeyama 1991).
///
/// Both lists are in the mesh's unit: multiply points in meters by 1000 for a mesh in millimeters.
/// `weights`: one for each pair, or empty for equal weights; only their ratios matter. They should
/// be proportional to 1 / (localization error)^2 of the pair, as target_error assumes.
///
/// Throws Error for fewer than 3 pairs, different counts, numbers that are not finite or above
/// longest_length, and weights not above 0. Also throws Error for points that coincide or are on a
/// line (narrower than a thousandth of its length). Also throws Error if no rotation is best, as
/// can happen with pairs in the wrong order. Large residuals are not an error: see RigidFit::doubt.
RigidFit fit_rigid(std::span<const Vec3> measured, std::span<const Vec3> model,
                   std::span<const double> weights = {});

}  // namespace keepout
