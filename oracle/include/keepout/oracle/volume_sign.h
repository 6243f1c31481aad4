// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/vec3.h"

namespace keepout::oracle {

/// The sign, -1, 0 or 1, of det(b - a, c - a, d - a), which is > 0 for the origin and the three
/// unit vectors in their order. Always right: double arithmetic where its bound allows, integers
/// where not. Precondition: finite coordinates.
int volume_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace keepout::oracle
