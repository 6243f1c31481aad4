// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "path.h"

namespace keepout::trial {

/// See experiments/bone.py.
struct BoneProperties {
  double thickness, resistance, behind, blade, kerf;
};

/// The kerf and the tip in it: experiments/bone.py describes the model.
class Bone {
 public:
  Bone(const Path& path, const BoneProperties& properties, double tip_stiffness);

  /// Returns the place of a tip that would be at `robot` in air, and its force on the bone. The tip
  /// moves along, then across, then in depth. Each spring relaxes as the bone yields: the exact
  /// solution over the period. [mm, N]
  std::pair<Vec3, double> press(const Vec3& robot, double period);

  int rows() const noexcept { return rows_; }
  int columns() const noexcept { return columns_; }
  /// Returns the cut depths, row by row. [mm]
  const std::vector<double>& cut() const noexcept { return cut_; }

 private:
  struct Cell {
    int row, column;
  };

  /// Returns the cell at a place, so that the blade stays within the map across the path.
  Cell cell(double along, double across) const;
  /// Returns how much bone a cell has above a depth; soft tissue counts less. 0 beyond the ends.
  double bone(int row, int column, double depth) const;
  /// Returns a coordinate of the tip after a period, with bone of this area [mm^2] in the way.
  double follow(double tip, double robot, double area, double period) const;
  /// Returns the depth of the tip after a period, and cuts what is under the blade.
  double sink(Cell cell, double depth, double below, double period);

  const Path& path_;
  BoneProperties properties_;
  double stiffness_, specific_;
  int rows_, columns_, half_blade_, half_kerf_;
  std::vector<double> cut_;
  std::optional<Coordinates> tip_;
};

}  // namespace keepout::trial
