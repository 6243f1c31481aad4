// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "distance_field.h"
#include "rule.h"

namespace keepout::peers {

/// The use of a distance field.
enum class FieldUse {
  plane,  // one plane: n . motion >= -(distance - margin), with n along the gradient
  cut,    // in addition, the motion ends where the field falls below the margin
  sure    // like cut, with the margin enlarged by the largest error of the field: a proof
};

/// Returns the rule that most systems use today, with a field of distances. Sources: Bowyer,
/// Davies, Rodriguez y Baena, "Active constraints/virtual fixtures: a survey", IEEE T-RO 30, 2014;
/// the plane is a vector-field inequality of gain 1 (closest_point_planes.h).
///
/// With `cut` and `sure`, the rest of a shortened motion continues from there with a new plane, at
/// most three times. The straight motion to each new end is tested as well. In each
/// cube, the least value on the motion is bounded by the control points of its cubic polynomial. So
/// the field does not fall below the margin between two places, either. With `sure`, a tip that
/// starts at the enlarged margin therefore keeps the margin from the mesh on its whole path. A tip
/// that starts closer approaches no further.
std::unique_ptr<Rule> distance_field_rule(const Task& task, std::shared_ptr<DistanceField> field,
                                          FieldUse use);

}  // namespace keepout::peers
