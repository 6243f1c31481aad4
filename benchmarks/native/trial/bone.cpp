// SPDX-License-Identifier: BSD-3-Clause
#include "bone.h"

#include <algorithm>
#include <cmath>

namespace keepout::trial {
namespace {

constexpr double cell_width = 0.05;  // across the path [mm]
constexpr double half_width = 3.0;   // of the map [mm]

int rounded(double number) { return static_cast<int>(std::nearbyint(number)); }

}  // namespace

Bone::Bone(const Path& path, const BoneProperties& properties, double tip_stiffness)
    : path_(path),
      properties_(properties),
      stiffness_(tip_stiffness),
      specific_(properties.resistance / (properties.blade * properties.kerf)),
      rows_(static_cast<int>(path.points.size())),
      columns_(2 * rounded(half_width / cell_width) + 1),
      half_blade_(std::max(1, rounded(properties.blade / 2 / path.spacing))),
      half_kerf_(std::max(1, rounded(properties.kerf / 2 / cell_width))),
      cut_(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_), 0.0) {}

std::pair<Vec3, double> Bone::press(const Vec3& robot, double period) {
  const Coordinates air = path_.coordinates(robot);
  if (!tip_ || air.below <= 0.0) {
    tip_ = air;
    return {robot, 0.0};
  }
  const Coordinates before = *tip_;
  const Cell at = cell(before.along, before.across);
  const int ahead = air.along > before.along ? half_blade_ + 1 : -half_blade_ - 1;
  double front = 0.0;
  for (int column = at.column - half_kerf_; column <= at.column + half_kerf_; ++column) {
    front += bone(at.row + ahead, column, before.below);
  }
  Coordinates tip = before;
  tip.along = follow(before.along, air.along, front * cell_width, period);
  const int beside = air.across > before.across ? half_kerf_ + 1 : -half_kerf_ - 1;
  double wall = 0.0;
  for (int row = at.row - half_blade_; row <= at.row + half_blade_; ++row) {
    wall += bone(row, at.column + beside, before.below);
  }
  tip.across = follow(before.across, air.across, wall * path_.spacing, period);
  tip.below = sink(cell(tip.along, tip.across), before.below, air.below, period);
  tip_ = tip;
  const Vec3 place = robot + (path_.place(tip) - path_.place(air));
  const Vec3 stretched = place - robot;
  return {place, stiffness_ * std::sqrt(dot(stretched, stretched))};
}

Bone::Cell Bone::cell(double along, double across) const {
  const int column = static_cast<int>((across + half_width) / cell_width + 0.5);
  const int most = columns_ - 2 - half_kerf_;
  return {static_cast<int>(along / path_.spacing + 0.5),
          std::min(std::max(column, half_kerf_ + 1), most)};
}

double Bone::bone(int row, int column, double depth) const {
  if (row < 0 || row >= rows_) return 0.0;
  const double cut = cut_[static_cast<std::size_t>(row * columns_ + column)];
  const double thickness = properties_.thickness;
  const double hard = std::max(0.0, std::min(depth, thickness) - std::min(cut, thickness));
  const double soft = std::max(0.0, depth - std::max(cut, thickness));
  return hard + properties_.behind * soft;
}

double Bone::follow(double tip, double robot, double area, double period) const {
  if (area <= 0.0) return robot;
  return robot - (robot - tip) * std::exp(-stiffness_ * period / (specific_ * area));
}

double Bone::sink(Cell at, double depth, double below, double period) {
  const int first = std::max(0, at.row - half_blade_);
  const int last = std::min(rows_ - 1, at.row + half_blade_);
  const auto each = [&](auto&& visit) {
    for (int row = first; row <= last; ++row) {
      double* const cells = cut_.data() + row * columns_ + at.column;
      for (int column = -half_kerf_; column <= half_kerf_; ++column) visit(cells[column]);
    }
  };
  if (below <= depth) {
    depth = below;
  } else {
    int bearing = 0;
    double highest = cut_[static_cast<std::size_t>(first * columns_ + at.column)];
    each([&](const double& cut) {
      bearing += cut <= depth;
      highest = std::min(highest, cut);
    });
    if (bearing == 0) {
      depth = std::min(below, highest);  // falls to the highest bone under the blade
    } else {
      const double softness = depth < properties_.thickness ? 1.0 : properties_.behind;
      depth = follow(depth, below, bearing * (path_.spacing * cell_width) * softness, period);
    }
  }
  each([&](double& cut) { cut = std::max(cut, depth); });
  return depth;
}

}  // namespace keepout::trial
