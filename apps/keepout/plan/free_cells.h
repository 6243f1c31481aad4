// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "keepout/geometry/box.h"
#include "verify/scene.h"

namespace keepout::app {

/// The places of a grid that a tip can reach from one of them. A cell is free when it is at least
/// the clearance and half a spacing from the mesh: then the straight way between neighbours keeps
/// the clearance, so what is reached can be reached indeed. No planner has a part in it.
class FreeCells {
 public:
  using Cell = std::uint32_t;

  /// Floods from the cell nearest to `from`. Nothing is reached when it is not free. `told`: up to
  /// where distances from the mesh are of interest. [length]
  FreeCells(Scene& scene, const Box& bounds, double spacing, double clearance, double told,
            const Vec3& from);

  const std::vector<Cell>& reached() const noexcept { return reached_; }
  Vec3 center(Cell cell) const noexcept;
  double distance(Cell cell) const noexcept { return distance_[cell]; }  // infinite: not told

  /// The length of the shortest way along the grid to each cell, in steps; max(): none.
  std::vector<std::uint32_t> steps_from(Cell cell) const;

  /// The steps between two cells if all were free.
  std::uint32_t steps_in_the_open(Cell a, Cell b) const noexcept;

 private:
  struct Place {
    std::uint32_t x, y, z;
  };
  Place place(Cell cell) const noexcept;
  template <class Visit>
  void for_each_neighbor(Cell cell, const Visit& visit) const;

  Vec3 low_;
  double spacing_;
  std::uint32_t nx_, ny_, nz_;
  std::vector<float> distance_;  // of the reached; < 0: not looked at, or not free
  std::vector<Cell> reached_;
};

}  // namespace keepout::app
