// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "keepout/error.h"
#include "keepout/fixtures/random.h"
#include "plan/planning.h"

namespace keepout::app {
namespace {

constexpr double cells_of_diagonal = 200.0;
constexpr double most_cells_of_side = 300.0;  // of the bounds, which may be much wider than a small
                                              // mesh
constexpr double nearest_clearances = 5.0;
constexpr double least_way = 0.25;  // of the diagonal
constexpr double least_detour = 1.3;
constexpr int places_within = 1000;
constexpr std::size_t most_draws = 2000;  // for each problem

Vec3 draw(const Box& box, Random& random) {
  const double x = random.uniform(box.low.x(), box.high.x());
  const double y = random.uniform(box.low.y(), box.high.y());
  const double z = random.uniform(box.low.z(), box.high.z());
  return {x, y, z};
}

/// Returns the widest of some places in the bounds and within the mesh.
Vec3 widest_within(Scene& scene, const Box& bounds, Random& random) {
  Vec3 widest = bounds.center();
  double distance = -1.0;
  int found = 0;
  for (int i = 0; found < places_within && i < 100 * places_within; ++i) {
    const Vec3 point = draw(bounds, random);
    const std::optional<bool> inside = scene.oracle().inside(point);
    if (!inside) {
      throw Error(scene.name() +
                  ": the mesh is open, so it has no inside; 'keepout inspect' shows where");
    }
    if (!*inside) continue;
    ++found;
    const double here = scene.nearest(point, std::max(distance, 0.0)).closest.distance;
    if (here > distance) {
      distance = here;
      widest = point;
    }
  }
  return widest;
}

/// The cells of a grid that a tip can reach from one of them. A free cell is at least the clearance
/// and half a spacing away from the mesh. Then the straight motion between neighbors maintains the
/// clearance, so every reached cell is truly reachable. No planner is involved.
class FreeCells {
 public:
  using Cell = std::uint32_t;

  /// Floods from the cell nearest to `from`; reaches no cell if that one is not free. `told`:
  /// distances from the mesh are computed up to this limit [length]. Ends early after a stop.
  FreeCells(Scene& scene, const Box& bounds, double spacing, double clearance, double told,
            const Vec3& from, const StopSignal& stop)
      : low_(bounds.low),
        spacing_(spacing),
        nx_(count(bounds.size().x(), spacing)),
        ny_(count(bounds.size().y(), spacing)),
        nz_(count(bounds.size().z(), spacing)),
        distance_(std::size_t{nx_} * ny_ * nz_, not_looked_at) {
    const double needed = clearance + 0.5 * spacing;
    const double reach = std::max(needed, told);
    TriangleBuffer candidates(scene.mesh()->triangle_count());
    const Box mesh = scene.mesh()->bounds();
    const auto distance_of = [&](const Vec3& point, double guess) {
      // Most cells are beside the box of a small mesh, or far from its triangles.
      constexpr double infinity = std::numeric_limits<double>::infinity();
      const Vec3 beside = (mesh.low - point).cwiseMax(point - mesh.high);
      if (beside.maxCoeff() > reach) return infinity;
      candidates.clear();
      scene.index().collect({point, reach}, candidates);
      if (candidates.view().empty()) return infinity;
      return scene.nearest(point, std::min(guess, reach)).closest.distance;
    };
    const auto look = [&](Cell cell, double guess) {
      if (distance_[cell] != not_looked_at) return;
      const double distance = distance_of(center(cell), guess);
      distance_[cell] = distance >= needed ? static_cast<float>(distance) : not_free;
      if (distance >= needed) reached_.push_back(cell);
    };
    const Vec3 at = ((from - low_) / spacing).array().round();
    const auto clamped = [](double value, std::uint32_t size) {
      return static_cast<std::uint32_t>(std::clamp(value, 0.0, static_cast<double>(size - 1)));
    };
    look(clamped(at.x(), nx_) + nx_ * (clamped(at.y(), ny_) + ny_ * clamped(at.z(), nz_)), 0.0);
    for (std::size_t i = 0; i < reached_.size() && !stop.has_come(); ++i) {
      const double guess = distance_[reached_[i]] + spacing;
      for_each_neighbor(reached_[i], [&](Cell next) { look(next, guess); });
    }
  }

  const std::vector<Cell>& reached() const noexcept { return reached_; }
  double distance(Cell cell) const noexcept { return distance_[cell]; }  // infinite: far away

  Vec3 center(Cell cell) const noexcept {
    const Place at = place(cell);
    return low_ + spacing_ * Vec3(at[0], at[1], at[2]);
  }

  /// Returns the length of the shortest path along the grid between two reached cells, in steps. By
  /// A* (Hart, Nilsson, Raphael 1968): where the way is open, it visits few cells more than the
  /// path has. Throws std::logic_error if no path leads from one to the other.
  std::uint32_t steps_between(Cell from, Cell to) {
    // Cells whose path through them may be as short as any that is left, and 2 steps longer: no
    // step changes that length by anything else.
    std::vector<Cell> open{from}, later;
    std::vector<Cell> seen{from};
    std::uint32_t length = steps_in_the_open(from, to);
    steps_.resize(distance_.size(), unknown);
    steps_[from] = 0;
    while (steps_[to] > length) {
      if (open.empty()) {
        if (later.empty())
          throw std::logic_error("steps_between: no path between two reached cells");
        length += 2;
        open.swap(later);
        continue;
      }
      const Cell cell = open.back();
      open.pop_back();
      const std::uint32_t here = steps_[cell];
      if (here + steps_in_the_open(cell, to) < length) continue;  // it was visited meanwhile
      for_each_neighbor(cell, [&](Cell next) {
        if (distance_[next] < 0.0F || steps_[next] <= here + 1) return;
        if (steps_[next] == unknown) seen.push_back(next);
        steps_[next] = here + 1;
        (here + 1 + steps_in_the_open(next, to) > length ? later : open).push_back(next);
      });
    }
    const std::uint32_t steps = steps_[to];
    for (const Cell cell : seen) steps_[cell] = unknown;
    return steps;
  }

  /// Returns the steps between two cells if all were free.
  std::uint32_t steps_in_the_open(Cell a, Cell b) const noexcept {
    const Place from = place(a), to = place(b);
    std::uint32_t steps = 0;
    for (std::size_t i = 0; i < 3; ++i)
      steps += std::max(from[i], to[i]) - std::min(from[i], to[i]);
    return steps;
  }

 private:
  using Place = std::array<std::uint32_t, 3>;

  static constexpr float not_looked_at = -1.0F;
  static constexpr float not_free = -2.0F;
  static constexpr std::uint32_t unknown = std::numeric_limits<std::uint32_t>::max();

  static std::uint32_t count(double length, double spacing) {
    return 1 + static_cast<std::uint32_t>(std::floor(length / spacing));
  }

  Place place(Cell cell) const noexcept { return {cell % nx_, cell / nx_ % ny_, cell / nx_ / ny_}; }

  template <class Visit>
  void for_each_neighbor(Cell cell, const Visit& visit) const {
    const auto [x, y, z] = place(cell);
    if (x > 0) visit(cell - 1);
    if (x + 1 < nx_) visit(cell + 1);
    if (y > 0) visit(cell - nx_);
    if (y + 1 < ny_) visit(cell + nx_);
    if (z > 0) visit(cell - nx_ * ny_);
    if (z + 1 < nz_) visit(cell + nx_ * ny_);
  }

  Vec3 low_;
  double spacing_;
  std::uint32_t nx_, ny_, nz_;
  std::vector<float> distance_;  // of reached cells; < 0: not visited, or not free
  std::vector<Cell> reached_;
  std::vector<std::uint32_t> steps_;  // to each cell, while a path is searched
};

}  // namespace

std::vector<PlanningProblem> draw_problems(TipScene& where, double clearance, std::size_t count,
                                           std::uint64_t seed, const StopSignal& stop) {
  Random random(seed);
  Scene& scene = where.scene;
  const double diagonal = scene.mesh()->bounds().size().norm();
  const double spacing =
      std::max(diagonal / cells_of_diagonal, where.bounds.size().maxCoeff() / most_cells_of_side);
  Box start_box = where.bounds;
  if (where.starts_below) start_box.high.z() = start_box.low.z() + 0.1 * start_box.size().z();
  const Vec3 from = where.is_within ? widest_within(scene, start_box, random) : where.bounds.low;
  const double near_enough = nearest_clearances * clearance;
  FreeCells cells(scene, where.bounds, spacing, clearance, near_enough, from, stop);
  std::vector<FreeCells::Cell> near, starts;
  for (const FreeCells::Cell cell : cells.reached()) {
    if (cells.distance(cell) > near_enough) continue;
    near.push_back(cell);
    if (cells.center(cell).z() <= start_box.high.z()) starts.push_back(cell);
  }

  std::vector<PlanningProblem> problems;
  oracle::SafetyOracle oracle = scene.oracle();
  for (std::size_t draws = 0; draws < most_draws * count && problems.size() < count; ++draws) {
    if (stop.has_come()) return problems;
    if (starts.empty()) break;
    const FreeCells::Cell start = starts[random.below(starts.size())];
    const FreeCells::Cell goal = near[random.below(near.size())];
    const Vec3 a = cells.center(start);
    const Vec3 b = cells.center(goal);
    if (a == b || !oracle.check(a, b, 0.0).crosses) continue;
    const std::uint32_t steps = cells.steps_between(start, goal);
    const double detour =
        static_cast<double>(steps) / static_cast<double>(cells.steps_in_the_open(start, goal));
    if (steps * spacing < least_way * diagonal || detour < least_detour) continue;
    problems.push_back({.number = problems.size() + 1,
                        .start = {a.begin(), a.end()},
                        .goal = {b.begin(), b.end()},
                        .members = {{"start", json_of(a)},
                                    {"goal", json_of(b)},
                                    {"straight_mm", (b - a).norm()},
                                    {"detour", detour}}});
  }
  if (problems.size() < count) {
    throw Error(scene.name() + ": only " + std::to_string(problems.size()) + " of " +
                std::to_string(count) + " problems were found with a clearance of " +
                std::to_string(clearance) +
                " mm; ask for fewer, or for a smaller --tool-radius or --margin. In a problem, the "
                "straight motion must meet the mesh, so a convex space has none");
  }
  return problems;
}

}  // namespace keepout::app
