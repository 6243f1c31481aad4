// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace keepout {

/// A point, or a displacement, in the frame of the mesh. [length]
using Vec3 = Eigen::Vector3d;

}  // namespace keepout
