// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/adapters/anatomical_space.h"

namespace keepout {

std::string_view name(AnatomicalSpace space) noexcept {
  switch (space) {
    case AnatomicalSpace::unstated:
      return "unstated";
    case AnatomicalSpace::ras:
      return "RAS";
    case AnatomicalSpace::lps:
      return "LPS";
  }
  return "unknown";
}

void swap_ras_and_lps(Surface& surface) noexcept {
  // From 0, so that no 0 becomes -0.
  for (Vec3& v : surface.vertices) v = Vec3(0.0 - v.x(), 0.0 - v.y(), v.z());
}

}  // namespace keepout
