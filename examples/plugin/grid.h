// SPDX-License-Identifier: BSD-3-Clause
// A uniform grid with its own traversal along motions, so that the certified rule does not collect
// all triangles in the region of a motion.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "keepout/geometry/closest_point.h"
#include "keepout/index/spatial_index.h"

/// One grid for each class of sizes of triangles: each class has triangles of half the size of the
/// class before. A triangle is only in the cell that contains the center of its box.
class Grid final : public keepout::SpatialIndex {
 public:
  explicit Grid(std::shared_ptr<const keepout::Mesh> on) : SpatialIndex(std::move(on)) {
    std::vector<keepout::Ball> spheres(mesh().triangle_count());
    std::array<std::vector<keepout::TriangleId>, most_levels> of_level;
    const double largest = mesh().longest_edge();
    for (keepout::TriangleId t = 0; t < spheres.size(); ++t) {
      const keepout::Triangle c = mesh().triangle(t);
      const keepout::Vec3 low = c[0].cwiseMin(c[1]).cwiseMin(c[2]);
      const keepout::Vec3 high = c[0].cwiseMax(c[1]).cwiseMax(c[2]);
      const keepout::Vec3 middle = 0.5 * (low + high);
      double radius = 0.0;
      for (const keepout::Vec3& corner : c) radius = std::max(radius, (corner - middle).norm());
      spheres[t] = {middle, radius};
      constexpr double finest = most_levels - 1;
      const double halvings = radius > 0.0 ? std::log2(largest / radius) : finest;
      of_level[static_cast<std::size_t>(std::clamp(halvings, 0.0, finest))].push_back(t);
    }
    for (const auto& triangles : of_level) {
      if (!triangles.empty()) levels_.emplace_back(spheres, triangles);
    }
  }

  void collect(const keepout::Ball& ball,
               keepout::TriangleBuffer& candidates) const noexcept override {
    for_each_in(ball, [&](keepout::TriangleId t, const keepout::Ball&) { candidates.push(t); });
  }

  bool traverses() const noexcept override { return true; }
  std::unique_ptr<keepout::MotionTraversal> traverse_along_motions(
      keepout::Budget& budget) const override {
    return std::make_unique<Traversal>(*this, budget);
  }

  std::size_t memory() const noexcept override {
    std::size_t bytes = 0;
    for (const Level& level : levels_) bytes += level.memory();
    return bytes;
  }

 private:
  static constexpr std::size_t most_levels = 16;

  /// One grid.
  class Level {
   public:
    Level(const std::vector<keepout::Ball>& spheres,
          const std::vector<keepout::TriangleId>& triangles)
        : low_(spheres[triangles[0]].center), items_(triangles.size()) {
      keepout::Vec3 high = low_;
      for (const keepout::TriangleId t : triangles) {
        low_ = low_.cwiseMin(spheres[t].center);
        high = high.cwiseMax(spheres[t].center);
        largest_ = std::max(largest_, spheres[t].radius);
      }
      const keepout::Vec3 size = high - low_;
      const double most_cells = 4.0 * static_cast<double>(triangles.size()) + 8.0;
      double cell = std::max(2.0 * largest_, 1e-3 * size.maxCoeff());
      for (double cells = 2.0 * most_cells; cells > most_cells; cell *= 1.2) {
        cells = 1.0;
        per_length_ = cell > 0.0 ? 1.0 / cell : 0.0;
        for (int axis = 0; axis < 3; ++axis) {
          side_[axis] = 1 + static_cast<int>(size[axis] * per_length_);
          cells *= side_[axis];
        }
      }
      // The triangles of a cell follow each other: count them, then place them.
      first_.resize(cell_of(side_[0] - 1, side_[1] - 1, side_[2] - 1) + 2);
      const auto cell_of_triangle = [&](keepout::TriangleId t) {
        const keepout::Vec3& center = spheres[t].center;
        return cell_of(place(center, 0), place(center, 1), place(center, 2));
      };
      for (const keepout::TriangleId t : triangles) ++first_[cell_of_triangle(t) + 1];
      for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
      std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
      for (const keepout::TriangleId t : triangles) {
        items_[next[cell_of_triangle(t)]++] = {spheres[t], t};
      }
    }

    template <class Call>
    void for_each_in(const keepout::Ball& ball, const Call& call) const noexcept {
      const double reach = ball.radius + largest_ * (1.0 + 1e-12);
      const keepout::Vec3 low = ball.center.array() - reach;
      const keepout::Vec3 high = ball.center.array() + reach;
      const int first_z = place(low, 2), last_z = place(high, 2);
      for (int x = place(low, 0); x <= place(high, 0); ++x) {
        for (int y = place(low, 1); y <= place(high, 1); ++y) {
          const std::uint32_t end = first_[cell_of(x, y, last_z) + 1];
          for (std::uint32_t i = first_[cell_of(x, y, first_z)]; i < end; ++i) {
            const keepout::Ball& sphere = items_[i].sphere;
            const double touching = ball.radius + sphere.radius * (1.0 + 1e-12);
            if ((sphere.center - ball.center).squaredNorm() > touching * touching) continue;
            call(items_[i].triangle, sphere);
          }
        }
      }
    }

    std::size_t memory() const noexcept {
      return first_.capacity() * sizeof(first_[0]) + items_.capacity() * sizeof(items_[0]);
    }

   private:
    struct Item {
      keepout::Ball sphere;
      keepout::TriangleId triangle;
    };

    /// Returns the cell of a point along an axis. It grows with the coordinate in spite of
    /// rounding.
    int place(const keepout::Vec3& point, int axis) const noexcept {
      const double at = (point[axis] - low_[axis]) * per_length_;
      return static_cast<int>(std::clamp(at, 0.0, side_[axis] - 1.0));
    }
    std::size_t cell_of(int x, int y, int z) const noexcept {
      return (static_cast<std::size_t>(x) * static_cast<std::size_t>(side_[1]) +
              static_cast<std::size_t>(y)) *
                 static_cast<std::size_t>(side_[2]) +
             static_cast<std::size_t>(z);
    }

    keepout::Vec3 low_;
    double largest_ = 0.0;  // radius of a sphere [length]
    double per_length_ = 0.0;
    std::array<int, 3> side_{};         // cells along each axis
    std::vector<std::uint32_t> first_;  // of each cell, and the end
    std::vector<Item> items_;           // cell by cell
  };

  /// The traversal. It collects the triangles around the tip from the grid only when the tip leaves
  /// a padded ball. For each motion, it proves most of them clear: by their spheres, and by the
  /// plane through the point that is nearest to the tip.
  class Traversal final : public keepout::MotionTraversal {
   public:
    Traversal(const Grid& grid, keepout::Budget& budget) : grid_(grid), budget_(budget) {
      near_.reserve(most_triangles);
      in_reach_.reserve(most_triangles);
      order_.reserve(most_triangles);
    }

    bool begin(const Start& start) noexcept override {
      tip_ = start.tip;
      longest_ = start.longest;
      const keepout::Ball& region = start.region;
      const bool is_known = (region.center - ball_.center).norm() + region.radius <= ball_.radius;
      if (!is_known && !fill({region.center, region.radius + padding_}) && !fill(region)) {
        ball_.radius = -1.0;
        budget_.mark_overflow();
        return false;
      }
      begin_again(start.level);
      return true;
    }

    void begin_again(double level) noexcept override {
      level_ = level;
      rounding_ = grid_.rounding_at(tip_) + 1e-9 * (level + longest_);
      in_reach_.clear();
      budget_.spend(1 + near_.size() / 16);
      for (Near& near : near_) {
        const keepout::Vec3 away = tip_ - near.sphere.center;
        const double reach = level_ + longest_ + near.sphere.radius + rounding_;
        if (away.squaredNorm() <= reach * reach) in_reach_.push_back({.near = &near, .away = away});
      }
    }

    bool region_is_empty() const noexcept override { return in_reach_.empty(); }

    bool traversal(const keepout::Vec3& motion,
                   keepout::TriangleVisitor& visitor) noexcept override {
      const double squared = motion.squaredNorm();
      const double slack = rounding_ + 2.0 * alike * std::sqrt(squared);
      order_.clear();
      budget_.spend(1 + in_reach_.size() / 16);
      for (Triangle& triangle : in_reach_) {
        // Is the sphere clear?
        const double fall = triangle.away.dot(motion);
        const double at = fall < 0.0 ? std::min(-fall / squared, 1.0) : 0.0;
        const double clear = level_ + triangle.near->sphere.radius + slack;
        if ((triangle.away + at * motion).squaredNorm() > clear * clear) continue;
        // Is the plane clear?
        if (triangle.distance < 0.0) measure(triangle);
        const double above = triangle.distance - level_ - slack;
        // The fraction of the motion until which it is clear. Triangles near the tip come first,
        // even if the visitor returns a negative fraction.
        double time = -std::numeric_limits<double>::infinity();
        if (above > 0.0) {
          const double descent = -triangle.towards_tip.dot(motion);
          if (descent < above) continue;
          time = above / descent * (1.0 - 1e-9);
        }
        order_.emplace_back(time, &triangle);
      }
      std::sort(order_.begin(), order_.end());
      double latest = never;
      for (const auto& [time, triangle] : order_) {
        if (time > latest || budget_.is_spent()) return false;
        const keepout::Triangle* corners = nullptr;
        keepout::Triangle relative;
        if (triangle->note == no_note) {
          relative = triangle->near->corners;
          for (keepout::Vec3& corner : relative) corner -= tip_;
          corners = &relative;
        }
        latest = visitor.visit(triangle->near->triangle, triangle->note, corners);
      }
      return order_.empty();
    }

    std::size_t room() const noexcept override { return most_triangles; }

   private:
    static constexpr std::size_t most_triangles = 4096;

    /// A triangle in the ball. Its corners are in lexicographic order, once they are needed.
    struct Near {
      keepout::TriangleId triangle;
      bool has_corners = false;
      keepout::Ball sphere;
      keepout::Triangle corners;
    };
    /// A triangle that a motion of this cycle may reach.
    struct Triangle {
      Near* near;
      keepout::Vec3 away;      // from the center of the sphere to the tip
      double distance = -1.0;  // from the tip; below 0: not measured yet
      keepout::Vec3 towards_tip = keepout::Vec3::Zero();  // unit, from the nearest point
      std::uint32_t note = no_note;
    };

    /// Stores the triangles that may touch the ball. Returns false if they are too many.
    bool fill(const keepout::Ball& ball) noexcept {
      near_.clear();
      bool fits = true;
      grid_.for_each_in(ball, [&](keepout::TriangleId t, const keepout::Ball& sphere) {
        fits = near_.size() < most_triangles;
        if (fits) near_.push_back({.triangle = t, .sphere = sphere, .corners = {}});
      });
      budget_.spend(8 + near_.size() / 4);
      // A larger ball lasts longer, and a smaller one has fewer triangles to test in each cycle.
      if (near_.size() < 32) padding_ = 1.5 * padding_ + 0.1 * longest_;
      if (near_.size() > 128) padding_ *= fits ? 0.7 : 0.0;
      ball_ = ball;
      return fits;
    }

    void measure(Triangle& triangle) noexcept {
      budget_.spend(1);
      Near& near = *triangle.near;
      if (!near.has_corners) {
        near.corners =
            keepout::ordered_relative(grid_.mesh().triangle(near.triangle), keepout::Vec3::Zero());
        near.has_corners = true;
      }
      const keepout::ClosestPoint closest = keepout::closest_point_of_ordered(near.corners, tip_);
      triangle.distance = closest.distance;
      if (closest.distance > 0.0) triangle.towards_tip = -closest.offset / closest.distance;
    }

    const Grid& grid_;
    keepout::Budget& budget_;
    double padding_ = 0.0;                             // of the next ball [length]
    keepout::Ball ball_{keepout::Vec3::Zero(), -1.0};  // that near_ covers
    std::vector<Near> near_;

    // The state of the present cycle.
    keepout::Vec3 tip_ = keepout::Vec3::Zero();
    double level_ = 0.0, longest_ = 0.0, rounding_ = 0.0;  // [length]
    std::vector<Triangle> in_reach_;
    std::vector<std::pair<double, Triangle*>> order_;  // the earliest first
  };

  /// Calls a function with each triangle whose sphere touches the ball, and with the sphere.
  template <class Call>
  void for_each_in(const keepout::Ball& ball, const Call& call) const noexcept {
    const double radius = ball.radius * (1.0 + 1e-12) + rounding_at(ball.center);
    for (const Level& level : levels_) level.for_each_in({ball.center, radius}, call);
  }

  /// Returns a bound of the roundings of coordinates, for a query at a point. [length]
  double rounding_at(const keepout::Vec3& point) const noexcept {
    return 1e-12 *
           (point.lpNorm<1>() + mesh().bounds().low.lpNorm<1>() + mesh().bounds().high.lpNorm<1>());
  }

  std::vector<Level> levels_;
};
