// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "keepout/control/rigid_fit.h"

namespace keepout {

/// By how much a registration is expected to be off at a target: normal, with mean 0.
struct TargetError {
  Mat3 covariance = Mat3::Zero();  // of the displacement, in the mesh's axes [length^2]

  /// The target registration error, TRE: how far off the target is, root mean square. [length]
  double rms() const noexcept;
  /// The standard deviation in the direction in which it is largest. [length]
  double worst_deviation() const noexcept;
};

/// The error of a fit at a target, a point in the frame of the mesh, to first order in the errors
/// of the pairs: independent, alike in all directions, and of a pair with weight w and of mean
/// weight v the variance FLE^2 / 3 v / w in each. With p the target from the fit's center,
///
///     covariance = FLE^2 / 3 (I / N + [p] looseness [p]^T),    [p] x = p cross x
///
/// whose trace is FLE^2 / N (1 + 1/3 sum d_k^2 / f_k^2), with d_k of the target and
/// f_k of the pairs, root mean square, from the k-th principal axis (Fitzpatrick, West, Maurer
/// 1998). `fle`: the localisation error, root mean square [length]; without, what the residuals let
/// expect. Throws Error for a target or an `fle` that is not finite, and for an `fle` not above 0.
TargetError target_error(const RigidFit& fit, const Vec3& target, std::optional<double> fle = {});

/// What to add to a guard's margin, so that with the probability `confidence` the registration is
/// off by no more: at the target, where it is one; where they are several, at all points of their
/// convex hull at once, such as of the eight corners of a box that the tool works in. [length]
///
/// It is the worst_deviation, s, times a quantile of the error's length were it as large in all
/// directions: chi of 3 degrees of freedom for one target, for no deviation is larger than s; chi
/// of 6 for several, for all come of the same three turns and three shifts. Where the FLE is
/// estimated, so is s, and the quantile is sqrt(k F(k, 3 N - 6)) in chi's place. The hull adds
/// nothing to its corners, as s is a convex function of the place.
///
/// It does not cover what all pairs have in common, such as a tool measured too long, nor what
/// moves later. Throws Error where target_error does, without a target, and for a confidence not
/// above 0 or beyond 0.9999, where errors are no longer known to be normal.
double registration_margin(const RigidFit& fit, std::span<const Vec3> targets,
                           double confidence = 0.99, std::optional<double> fle = {});

}  // namespace keepout
