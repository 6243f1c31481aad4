// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "compare/compare.h"
#include "keepout/adapters/narrow_phase_registry.h"
#include "keepout/fixtures/random.h"

namespace keepout::app {
namespace {

/// Returns the tip of a drill: a cone with twelve sides on a prism with twelve.
ConvexTool drill() {
  std::vector<Vec3> points{Vec3(0, 0, -1.5)};
  for (int i = 0; i < 12; ++i) {
    const double angle = i * (3.14159265358979323846 / 6.0);
    for (const double height : {0.0, 3.0}) {
      points.emplace_back(1.5 * std::cos(angle), 1.5 * std::sin(angle), height);
    }
  }
  return ConvexTool::hull(points);
}

std::vector<std::pair<std::string_view, ConvexTool>> tools_to_compare() {
  return {{"sphere", ConvexTool::sphere(2.0)},
          {"capsule", ConvexTool::capsule({0, 0, 0}, {0, 0, 5}, 1.0)},
          {"box", ConvexTool::box({Vec3(-1.5, -0.25, 0), Vec3(1.5, 0.25, 4)})},
          {"hull", drill()}};
}

constexpr double overlapping = 1e-3;    // at least [mm]
constexpr double farthest_apart = 5.0;  // [mm]
constexpr double deepest_wanted = 1.5;  // target; the result may be less [mm]
constexpr std::size_t orientations = 16;

/// The relation of a pair, and how to draw its target distance.
struct Relation {
  std::string_view name;
  double (*wanted)(Random&);
  bool (*holds)(double distance);
};

constexpr Relation relations[] = {
    {"apart", [](Random& r) { return r.uniform(2.0 * overlapping, farthest_apart); },
     [](double d) { return d >= overlapping; }},
    {"touching",
     [](Random& r) {
       const double size = std::pow(10.0, r.uniform(-12.0, -6.0));
       return 0.9 * (r.below(2) == 0 ? size : -size);
     },
     [](double d) { return std::abs(d) <= touch; }},
    {"overlapping", [](Random& r) { return -r.uniform(2.0 * overlapping, deepest_wanted); },
     [](double d) { return d <= -overlapping; }},
};

struct Pair {
  std::size_t tool;  // the number of the orientation
  Vec3 position;
  Triangle triangle;
  Separation exact;
};

std::vector<ConvexTool> turned(const ConvexTool& tool, Random& random) {
  std::vector<ConvexTool> tools;
  for (std::size_t i = 0; i < orientations; ++i) {
    const Eigen::AngleAxisd turn(random.uniform(0.0, 6.28), random.direction());
    tools.push_back(tool.rotated(turn.toRotationMatrix()));
  }
  return tools;
}

/// Moves each tool from a random place along the separation normal to the target distance. Returns
/// fewer pairs after a stop.
std::vector<Pair> make_pairs(const Mesh& mesh, const std::vector<ConvexTool>& tools,
                             const Relation& relation, std::size_t count, Random& random,
                             const Stopped& stopped) {
  std::vector<Pair> pairs;
  for (std::size_t attempt = 0; pairs.size() < count && attempt < 100 * count && !stopped();
       ++attempt) {
    Pair pair;
    pair.tool = pairs.size() % tools.size();
    const ConvexTool& tool = tools[pair.tool];
    pair.triangle = mesh.triangle(static_cast<TriangleId>(random.below(mesh.triangle_count())));
    const Vec3 off = pair.triangle[0] + 20.0 * random.direction();
    const Separation there = separation(tool, off, pair.triangle);
    pair.position = off - (there.distance - relation.wanted(random)) * there.normal;
    pair.exact = separation(tool, pair.position, pair.triangle);
    if (relation.holds(pair.exact.distance)) pairs.push_back(pair);
  }
  return pairs;
}

/// Returns empty after a stop.
std::optional<NarrowPhaseAgreement> agreement_of(const NarrowPhaseBackend& backend,
                                                 const std::vector<ConvexTool>& tools,
                                                 const std::vector<Pair>& pairs, Progress& progress,
                                                 const Stopped& stopped) {
  std::vector<std::unique_ptr<NarrowPhase>> narrow_phases;
  for (const ConvexTool& tool : tools) narrow_phases.push_back(backend.make(tool));

  NarrowPhaseAgreement row{.backend = std::string(backend.name), .pairs = pairs.size()};
  std::vector<double> errors;
  const auto ask = [&](std::size_t i) {
    return narrow_phases[pairs[i].tool]->separation(pairs[i].position, pairs[i].triangle);
  };
  const auto judge = [&](std::size_t i, const NarrowPhaseAnswer& answer) {
    const Pair& pair = pairs[i];
    const Separation& told = answer.separation;
    if (!answer.answered() || !std::isfinite(told.distance)) {
      ++row.failed;
      return;
    }
    row.contradicted += (told.distance > 0.0) != (pair.exact.distance > 0.0);
    errors.push_back(std::abs(told.distance - pair.exact.distance));
    const double proven =
        separation_along(told.normal, tools[pair.tool], pair.position, pair.triangle);
    row.worst_unproven = std::max(row.worst_unproven, pair.exact.distance - proven);
  };
  const std::optional<Timing> timing = ask_all(pairs.size(), progress, stopped, ask, judge);
  if (!timing) return std::nullopt;
  row.us = *timing;
  const Timing spread = timing_of(errors);  // timing_of() ranks any numbers
  row.median_error = spread.p50;
  row.worst_error = spread.max;
  return row;
}

}  // namespace

std::vector<NarrowPhaseAgreement> compare_narrow_phases(const Mesh& mesh, std::size_t pairs,
                                                        std::uint64_t seed,
                                                        const Stopped& stopped) {
  const auto kinds = tools_to_compare();
  Progress progress("compare narrow phases",
                    kinds.size() * std::size(relations) * narrow_phase_backends().size() * pairs);
  std::vector<NarrowPhaseAgreement> rows;
  Random random(seed);
  for (const auto& [name, tool] : kinds) {
    const std::vector<ConvexTool> tools = turned(tool, random);
    for (const Relation& relation : relations) {
      const std::vector<Pair> same = make_pairs(mesh, tools, relation, pairs, random, stopped);
      if (stopped()) return rows;
      for (const NarrowPhaseBackend& backend : narrow_phase_backends()) {
        auto row = agreement_of(backend, tools, same, progress, stopped);
        if (!row) return rows;
        row->tool = name;
        row->relation = relation.name;
        rows.push_back(*std::move(row));
      }
    }
  }
  return rows;
}

}  // namespace keepout::app
