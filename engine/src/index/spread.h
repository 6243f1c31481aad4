// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

#include "keepout/geometry/vec3.h"
#include "median_split.h"

namespace keepout {

/// The middle of the triangles, from the middle of the mesh, and how they spread.
struct Spread {
  Vec3 mean;                   // [length]
  Eigen::Matrix3d covariance;  // times their number [length^2]
};

/// Of one triangle or more. In one pass, from the first of them: what is subtracted in the end is
/// of the size of the rest.
Spread spread_of(std::span<const Center> centers) noexcept;

/// Orthonormal rows, the direction of largest spread first. The eigenvectors only choose the frame;
/// the cross products make it orthonormal to rounding, which the box tests rely on.
Eigen::Matrix3d principal_axes(const Eigen::Matrix3d& covariance) noexcept;

}  // namespace keepout
