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

/// experiments/bone.py in C++: the same operations in the same order.
class Bone {
 public:
  Bone(const Path& path, const BoneProperties& properties, double tip_stiffness);

  /// Returns the place of a tip that would be at `robot` in air, and its force on the bone. [mm, N]
  std::pair<Vec3, double> press(const Vec3& robot, double period);

  int rows() const noexcept { return rows_; }
  int columns() const noexcept { return columns_; }
  /// Returns the cut depths, row by row. [mm]
  const std::vector<double>& cut() const noexcept { return cut_; }

 private:
  struct Cell {
    int row, column;
  };

  Cell cell(double along, double across) const;
  double bone(int row, int column, double depth) const;
  double follow(double tip, double robot, double area, double period) const;
  double sink(Cell cell, double depth, double below, double period);

  const Path& path_;
  BoneProperties properties_;
  double stiffness_, specific_;
  int rows_, columns_, half_blade_, half_kerf_;
  std::vector<double> cut_;
  std::optional<Coordinates> tip_;
};

}  // namespace keepout::trial
