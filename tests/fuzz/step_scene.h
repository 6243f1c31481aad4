// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "fuzz/harness.h"
#include "keepout/index/spatial_index.h"
#include "keepout/mesh/mesh.h"
#include "keepout/step/guide.h"
#include "realtime/counted_allocations.h"

namespace keepout::fuzz {

/// Returns a small mesh: random triangles, which may be degenerate and cross each other, or a
/// closed shape, maybe far from the origin.
std::shared_ptr<const Mesh> any_mesh(Source& source);

/// Returns the mesh with moved vertices.
std::shared_ptr<const Mesh> deformed(const Mesh& mesh, Source& source);

/// Returns the diagonal of the bounds, at least 1e-3. [length]
double size_of(const Mesh& mesh) noexcept;

/// Returns a place at a distance from a point of a triangle, along its normal or anywhere. [length]
Vec3 place_near(const Mesh& mesh, double distance, Source& source) noexcept;

/// Returns a region about a place, which is inside of it or near it. Throws Error.
Region any_region(const Vec3& place, double size, Source& source);

/// Returns the result of a function of the control path, which must not allocate.
template <class Function>
auto without_allocation(const Function& function) {
  const std::size_t before = allocations();
  auto result = function();
  const std::size_t after = allocations();
  require(after == before, "the control path does not allocate");
  return result;
}

}  // namespace keepout::fuzz
