// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "keepout/mesh/mesh.h"

namespace keepout::test {

/// Returns one triangle in the plane x = `at`, larger than all that is near it.
inline std::shared_ptr<const Mesh> wall(double at) {
  return std::make_shared<const Mesh>(
      Surface{{Vec3(at, -300, -300), Vec3(at, 300, -300), Vec3(at, 0, 300)}, {{0, 1, 2}}});
}

}  // namespace keepout::test
