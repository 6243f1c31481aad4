// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <exception>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "keepout/factory/make_motion_constraint.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/mesh/load_mesh.h"

/// A mesh, the one index that all guards on it share, and what its file was found to be.
struct Anatomy {
  explicit Anatomy(keepout::LoadedMesh loaded)
      : mesh(std::move(loaded.mesh)),
        index(std::make_shared<const keepout::WideBvh>(mesh)),
        warnings(std::move(loaded.warnings)) {}

  explicit Anatomy(keepout::Surface surface)
      : Anatomy(keepout::LoadedMesh{
            .mesh = std::make_shared<const keepout::Mesh>(std::move(surface))}) {}

  /// A guard on it.
  keepout::MotionConstraint guard(const keepout::MotionConstraintSettings& settings) const {
    return make_motion_constraint(mesh, index, settings);
  }

  std::shared_ptr<const keepout::Mesh> mesh;
  std::shared_ptr<const keepout::SpatialIndex> index;
  std::vector<std::string> warnings;
  std::unique_ptr<keepout::MotionConstraint>
      probe;  // what keepout_clearance asks, once it was asked
};

namespace keepout::web {

inline std::string failure;  // why the last call that returned null failed

/// What make() makes; null, with a message, where it throws.
template <class Make>
auto made(const Make& make) noexcept -> decltype(make().release()) {
  try {
    return make().release();
  } catch (const std::bad_alloc&) {
    failure = "there is not enough memory for it";
  } catch (const std::exception& error) {
    failure = error.what();
  }
  return nullptr;
}

}  // namespace keepout::web
