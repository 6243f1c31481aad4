// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/geometry/vec3.h"

namespace keepout::oracle {

/// The closed straight way from one point to another; the two may coincide. [length]
struct Segment {
  Vec3 from;
  Vec3 to;
};

}  // namespace keepout::oracle
