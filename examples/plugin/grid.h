// SPDX-License-Identifier: BSD-3-Clause
// A uniform grid with its own traversal along motions, so that the certified rule does not collect
// all triangles in the region of a motion.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "keepout/geometry/closest_point.h"
#include "keepout/index/spatial_index.h"

/// One grid for each class of sizes of triangles: each class has triangles of half the size of the
/// class before. A triangle is only in the cell that contains the center of its box.
class Grid final : public keepout::SpatialIndex {
 public:
  explicit Grid(std::shared_ptr<const keepout::Mesh> on)
      : SpatialIndex(std::move(on)), spheres_(mesh().triangle_count()) {
    std::array<std::vector<keepout::TriangleId>, most_levels> of_level;
    const double largest = mesh().longest_edge();
    for (keepout::TriangleId t = 0; t < spheres_.size(); ++t) {
      const keepout::Triangle c = mesh().triangle(t);
      const keepout::Vec3 low = c[0].cwiseMin(c[1]).cwiseMin(c[2]);
      const keepout::Vec3 high = c[0].cwiseMax(c[1]).cwiseMax(c[2]);
      const keepout::Vec3 middle = 0.5 * (low + high);
      double radius = 0.0;
      for (const keepout::Vec3& corner : c) radius = std::max(radius, (corner - middle).norm());
      spheres_[t] = {middle, radius};
      constexpr double finest = most_levels - 1;
      const double halvings = radius > 0.0 ? std::log2(largest / radius) : finest;
      of_level[static_cast<std::size_t>(std::clamp(halvings, 0.0, finest))].push_back(t);
    }
    for (const auto& triangles : of_level) {
      if (!triangles.empty()) levels_.emplace_back(spheres_, triangles);
    }
  }

  void collect(const keepout::Ball& ball,
               keepout::TriangleBuffer& candidates) const noexcept override {
    const double radius = ball.radius + rounding_at(ball.center) + 1e-12 * ball.radius;
    for (const Level& level : levels_) level.collect({ball.center, radius}, spheres_, candidates);
  }

  bool traverses() const noexcept override { return true; }
  std::unique_ptr<keepout::MotionTraversal> traverse_along_motions(
      keepout::Budget& budget) const override {
    return std::make_unique<Traversal>(*this, budget);
  }

  std::size_t memory() const noexcept override {
    std::size_t bytes = spheres_.capacity() * sizeof(spheres_[0]);
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
        : low_(spheres[triangles[0]].center), triangles_(triangles.size()) {
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
      for (const keepout::TriangleId t : triangles) triangles_[next[cell_of_triangle(t)]++] = t;
    }

    void collect(const keepout::Ball& ball, const std::vector<keepout::Ball>& spheres,
                 keepout::TriangleBuffer& candidates) const noexcept {
      const double reach = ball.radius + largest_ * (1.0 + 1e-12);
      const keepout::Vec3 low = ball.center.array() - reach;
      const keepout::Vec3 high = ball.center.array() + reach;
      const int first_z = place(low, 2), last_z = place(high, 2);
      for (int x = place(low, 0); x <= place(high, 0); ++x) {
        for (int y = place(low, 1); y <= place(high, 1); ++y) {
          const std::uint32_t end = first_[cell_of(x, y, last_z) + 1];
          for (std::uint32_t i = first_[cell_of(x, y, first_z)]; i < end; ++i) {
            const keepout::Ball& sphere = spheres[triangles_[i]];
            const double touching = ball.radius + sphere.radius * (1.0 + 1e-12);
            if ((sphere.center - ball.center).squaredNorm() > touching * touching) continue;
            candidates.push(triangles_[i]);
          }
        }
      }
    }

    std::size_t memory() const noexcept {
      return first_.capacity() * sizeof(first_[0]) + triangles_.capacity() * sizeof(triangles_[0]);
    }

   private:
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
    std::vector<keepout::TriangleId> triangles_;
  };

  /// The traversal. It collects the triangles around the tip from the grid only when the tip leaves
  /// a padded ball. For each motion, it proves most of them clear: by their spheres, and by the
  /// plane through the point that is nearest to the tip.
  class Traversal final : public keepout::MotionTraversal {
   public:
    Traversal(const Grid& grid, keepout::Budget& budget)
        : grid_(grid), budget_(budget), collected_(most_triangles) {
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
      for (const Near& near : near_) {
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
        double time = 0.0;  // before which it is clear, as a fraction of the motion
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

    /// A triangle in the ball, with its corners in lexicographic order.
    struct Near {
      keepout::TriangleId triangle;
      keepout::Ball sphere;
      keepout::Triangle corners;
    };
    /// A triangle that a motion of this cycle may reach.
    struct Triangle {
      const Near* near;
      keepout::Vec3 away;      // from the center of the sphere to the tip
      double distance = -1.0;  // from the tip; below 0: not measured yet
      keepout::Vec3 towards_tip = keepout::Vec3::Zero();  // unit, from the nearest point
      std::uint32_t note = no_note;
    };

    /// Stores the triangles that may touch the ball. Returns false if they are too many.
    bool fill(const keepout::Ball& ball) noexcept {
      collected_.clear();
      grid_.collect(ball, collected_);
      budget_.spend(8 + collected_.size());
      near_.clear();
      if (collected_.overflowed()) {
        padding_ = 0.0;
        return false;
      }
      for (const keepout::TriangleId t : collected_) {
        near_.push_back(
            {t, grid_.spheres_[t],
             keepout::ordered_relative(grid_.mesh().triangle(t), keepout::Vec3::Zero())});
      }
      ball_ = ball;
      // A larger ball lasts longer, and a smaller one has fewer triangles to test in each cycle.
      padding_ = near_.size() < 64    ? 1.5 * padding_ + 0.1 * longest_
                 : near_.size() > 256 ? 0.7 * padding_
                                      : padding_;
      return true;
    }

    void measure(Triangle& triangle) noexcept {
      budget_.spend(1);
      const keepout::ClosestPoint closest =
          keepout::closest_point_of_ordered(triangle.near->corners, tip_);
      triangle.distance = closest.distance;
      if (closest.distance > 0.0) triangle.towards_tip = -closest.offset / closest.distance;
    }

    const Grid& grid_;
    keepout::Budget& budget_;
    keepout::TriangleBuffer collected_;
    double padding_ = 0.0;                             // of the next ball [length]
    keepout::Ball ball_{keepout::Vec3::Zero(), -1.0};  // that near_ covers
    std::vector<Near> near_;

    // The state of the present cycle.
    keepout::Vec3 tip_ = keepout::Vec3::Zero();
    double level_ = 0.0, longest_ = 0.0, rounding_ = 0.0;  // [length]
    std::vector<Triangle> in_reach_;
    std::vector<std::pair<double, Triangle*>> order_;  // the earliest first
  };

  /// Returns a bound of the roundings of coordinates, for a query at a point. [length]
  double rounding_at(const keepout::Vec3& point) const noexcept {
    return 1e-12 *
           (point.lpNorm<1>() + mesh().bounds().low.lpNorm<1>() + mesh().bounds().high.lpNorm<1>());
  }

  std::vector<keepout::Ball> spheres_;  // around each triangle
  std::vector<Level> levels_;
};
