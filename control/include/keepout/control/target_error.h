// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "keepout/control/rigid_fit.h"

namespace keepout {

/// The expected error of a registration at a target: normally distributed with mean 0.
struct TargetError {
  Mat3 covariance = Mat3::Zero();  // of the displacement, in the mesh's axes [length^2]

  /// Returns the target registration error (TRE): the root mean square displacement of the target.
  /// [length]
  double rms() const noexcept;
  /// Returns the standard deviation in the direction where it is largest. [length]
  double worst_deviation() const noexcept;
};

/// Returns the error of a fit at a target, a point in the frame of the mesh, to first order in the
/// errors of the pairs. These errors are assumed independent and equal in all directions. For a
/// pair of weight w and the mean weight v, the variance in each direction is FLE^2 / 3 v / w. With
/// p the target relative to the fit's center,
///
///     covariance = FLE^2 / 3 (I / N + [p] looseness [p]^T),    [p] x = p cross x
///
/// Its trace is FLE^2 / N (1 + 1/3 sum d_k^2 / f_k^2) (Fitzpatrick, West, Maurer 1998). There d_k
/// is the distance of the target from the k-th principal axis, and f_k the root mean square
/// distance of the pairs from this axis. `fle`: the localization error, root mean square [length];
/// by default estimated_fle(). Throws Error for a target or an `fle` that is not finite, and for an
/// `fle` not above 0.
TargetError target_error(const RigidFit& fit, const Vec3& target, std::optional<double> fle = {});

/// Returns the length to add to a guard's margin [length]. The registration error exceeds it only
/// with probability 1 - `confidence`. With one target, this probability holds at the target. With
/// several targets, it holds at all points of their convex hull at once. Eight corners, for
/// example, give the box of a work space.
///
/// The length is the worst_deviation s times a quantile. The quantile is that of the length of an
/// error whose standard deviation is 1 in all directions. For one target this length has a chi
/// distribution with k = 3 degrees of freedom. For several targets k is 6, as all errors come from
/// the same three rotations and three translations. If the FLE is estimated, so is s, and the
/// quantile is sqrt(k F(k, 3 N - 6)) instead. The corners of the hull are sufficient, as s is a
/// convex function of the position.
///
/// The length does not cover motion after the registration, or errors that all pairs share, such as
/// a wrong tool length. Throws Error like target_error, without a target, and for a confidence not
/// above 0 or above 0.9999, where the errors may not be normal.
double registration_margin(const RigidFit& fit, std::span<const Vec3> targets,
                           double confidence = 0.99, std::optional<double> fle = {});

}  // namespace keepout
