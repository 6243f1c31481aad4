// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "plan/problems.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "keepout/error.h"
#include "keepout/fixtures/random.h"
#include "plan/free_cells.h"

namespace keepout::app {
namespace {

constexpr double cells_of_diagonal = 200.0;
constexpr double room_around = 10.0;  // [mm]
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

/// The lowest tenth of a box.
Box lowest(Box box) {
  box.high.z() = box.low.z() + 0.1 * box.size().z();
  return box;
}

/// The widest of some places in the bounds and within the mesh.
Vec3 widest_within(Scene& scene, const Box& bounds, Random& random) {
  Vec3 widest = bounds.center();
  double distance = -1.0;
  int found = 0;
  for (int i = 0; found < places_within && i < 100 * places_within; ++i) {
    const Vec3 point = draw(bounds, random);
    const std::optional<bool> inside = scene.oracle().inside(point);
    if (!inside) {
      throw Error(scene.name() +
                  ": the mesh is open, so nothing is within it; 'keepout inspect' tells more");
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

using Cells = std::vector<FreeCells::Cell>;

Cells near_the_mesh(const FreeCells& cells, double distance) {
  Cells result;
  for (const FreeCells::Cell cell : cells.reached()) {
    if (cells.distance(cell) <= distance) result.push_back(cell);
  }
  return result;
}

Cells below(const FreeCells& cells, const Cells& from, double height) {
  Cells result;
  for (const FreeCells::Cell cell : from) {
    if (cells.center(cell).z() <= height) result.push_back(cell);
  }
  return result;
}

}  // namespace

PlanningScene planning_scene(std::unique_ptr<Scene> scene, PlanningScene::Space space,
                             PlanningScene::Starts starts) {
  Box bounds = scene->mesh()->bounds();
  if (space == PlanningScene::Space::around) {
    bounds.low.array() -= room_around;
    bounds.high.array() += room_around;
  }
  return {std::move(scene), space, starts, bounds};
}

std::vector<Problem> draw_problems(PlanningScene& where, double clearance, std::size_t count,
                                   std::uint64_t seed) {
  Random random(seed);
  Scene& scene = *where.scene;
  const double diagonal = scene.mesh()->bounds().size().norm();
  const double spacing = diagonal / cells_of_diagonal;
  const Box start_box =
      where.starts == PlanningScene::Starts::below ? lowest(where.bounds) : where.bounds;
  const Vec3 from = where.space == PlanningScene::Space::around
                        ? where.bounds.low
                        : widest_within(scene, start_box, random);
  const double near_enough = nearest_clearances * clearance;
  const FreeCells cells(scene, where.bounds, spacing, clearance, near_enough, from);
  const Cells near = near_the_mesh(cells, near_enough);
  const Cells starts = below(cells, near, start_box.high.z());

  std::vector<Problem> problems;
  oracle::SafetyOracle oracle = scene.oracle();
  for (std::size_t draws = 0; draws < most_draws * count && problems.size() < count; ++draws) {
    if (starts.empty()) break;
    const FreeCells::Cell start = starts[random.below(starts.size())];
    const FreeCells::Cell goal = near[random.below(near.size())];
    const Vec3 a = cells.center(start);
    const Vec3 b = cells.center(goal);
    if (a == b || !oracle.check(a, b, 0.0).crosses) continue;
    const std::uint32_t steps = cells.steps_from(start)[goal];
    const double detour =
        static_cast<double>(steps) / static_cast<double>(cells.steps_in_the_open(start, goal));
    if (steps * spacing < least_way * diagonal || detour < least_detour) continue;
    problems.push_back({problems.size() + 1, a, b, (b - a).norm(), detour});
  }
  if (problems.size() < count) {
    throw Error(scene.name() + ": only " + std::to_string(problems.size()) + " of " +
                std::to_string(count) + " problems were found with a clearance of " +
                std::to_string(clearance) +
                " mm; ask for fewer, or for a smaller --tool-radius or --margin");
  }
  return problems;
}

}  // namespace keepout::app
