// SPDX-License-Identifier: BSD-3-Clause
// An index of your own: a uniform grid in a motion constraint, checked against brute force.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "keepout/activation/registry.h"
#include "keepout/index/brute_force.h"
#include "keepout/keepout.h"
#include "keepout/solvers/registry.h"

/// Each triangle is only in the cell that contains the center of its box, so no triangle is
/// returned twice. A query region grows by half of the largest box, so no triangle is missed.
class UniformGrid final : public keepout::SpatialIndex {
 public:
  explicit UniformGrid(std::shared_ptr<const keepout::Mesh> on)
      : SpatialIndex(std::move(on)), box_(mesh().bounds()), cells_(side * side * side) {
    for (keepout::TriangleId t = 0; t < mesh().triangle_count(); ++t) {
      const keepout::Triangle c = mesh().triangle(t);
      const keepout::Vec3 low = c[0].cwiseMin(c[1]).cwiseMin(c[2]);
      const keepout::Vec3 high = c[0].cwiseMax(c[1]).cwiseMax(c[2]);
      const keepout::Vec3 middle = 0.5 * (low + high);
      half_ = half_.cwiseMax(high - middle).cwiseMax(middle - low);
      cells_[cell(place(middle, 0), place(middle, 1), place(middle, 2))].push_back(t);
    }
  }

  void collect(const keepout::Ball& ball,
               keepout::TriangleBuffer& candidates) const noexcept override {
    const double rounding = 1e-12 * (ball.radius + ball.center.norm() + box_.high.norm());
    const keepout::Vec3 reach = half_.array() + (ball.radius + rounding);
    const keepout::Vec3 low = ball.center - reach;
    const keepout::Vec3 high = ball.center + reach;
    for (int x = place(low, 0); x <= place(high, 0); ++x) {
      for (int y = place(low, 1); y <= place(high, 1); ++y) {
        for (int z = place(low, 2); z <= place(high, 2); ++z) {
          for (const keepout::TriangleId t : cells_[cell(x, y, z)]) candidates.push(t);
        }
      }
    }
  }

  std::size_t memory() const noexcept override {
    std::size_t bytes = cells_.capacity() * sizeof(cells_[0]);
    for (const auto& cell : cells_) bytes += cell.capacity() * sizeof(cell[0]);
    return bytes;
  }

 private:
  static constexpr int side = 48;  // cells along each axis

  /// Returns the cell of a point along an axis; beyond the grid, the last cell.
  int place(const keepout::Vec3& point, int axis) const {
    const double size = box_.high[axis] - box_.low[axis];
    const double share = size > 0.0 ? (point[axis] - box_.low[axis]) / size : 0.0;
    return static_cast<int>(std::clamp(std::floor(share * side), 0.0, side - 1.0));
  }
  static std::size_t cell(int x, int y, int z) {
    return static_cast<std::size_t>((x * side + y) * side + z);
  }

  keepout::Box box_;
  keepout::Vec3 half_ = keepout::Vec3::Zero();  // half of the largest box of a triangle
  std::vector<std::vector<keepout::TriangleId>> cells_;
};

keepout::MotionConstraint guard_with(std::unique_ptr<keepout::SpatialIndex> index,
                                     const std::shared_ptr<const keepout::Mesh>& mesh) {
  return {mesh,
          std::move(index),
          keepout::make_activation("certified"),
          keepout::make_solver("active_set"),
          {.radius = 2.0, .margin = 0.5}};
}

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s MESH\n", argv[0]);
    return 2;
  }
  const auto mesh = keepout::load_mesh(argv[1]).mesh;
  auto with_grid = guard_with(std::make_unique<UniformGrid>(mesh), mesh);
  auto with_brute_force = guard_with(std::make_unique<keepout::BruteForce>(mesh), mesh);

  // Straight down from above, then along the surface. The motion is bitwise identical with both
  // indices.
  keepout::Vec3 tip(mesh->bounds().center());
  tip.z() = mesh->bounds().high.z() + 2.0;
  int different = 0, held = 0;
  constexpr int cycles = 300;
  for (int cycle = 0; cycle < cycles; ++cycle) {
    const keepout::Motion motion{.tip = tip, .desired = {0.05, 0.0, -0.1}};
    const keepout::Step step = with_grid.step(motion);
    different += step.motion != with_brute_force.step(motion).motion;
    held += step.status != keepout::Status::free;
    tip += step.motion;
  }
  std::printf("held back in %d of %d cycles, %d unlike brute force\n", held, cycles, different);
  return different == 0 ? 0 : 1;
} catch (const keepout::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
