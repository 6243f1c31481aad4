// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
// One step in contact, each rule on the same poses. An index that disagrees with brute force is not
// timed.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/index/nearest.h"
#include "keepout/index/pd_tree.h"
#include "keepout/mesh/load_mesh.h"

namespace keepout {
namespace {

constexpr double margin = 0.2;  // [mm]

/// A hand that presses the tool against the CT skull and drags it along: tips in contact, the
/// increments asked for .05 to .2 mm long. The same for every rule.
struct Scene {
  std::shared_ptr<const Mesh> mesh = load_mesh(fixture_path("skull_1m")).mesh;
  std::vector<Motion> motions;

  Scene() {
    Random random(1);
    MotionConstraint guard = make_motion_constraint(mesh, {.margin = margin});
    const PdTree tree(mesh);
    NearestTriangle nearest(*mesh, tree);
    for (const Vec3& start : surface_points(*mesh, 200, 0.5, random)) {
      Vec3 tip = start;
      const Vec3 press = nearest(start).closest.offset.normalized();
      for (int cycle = 0; cycle < 60; ++cycle) {
        const Vec3 drag = random.uniform(0.05, 0.2) * (press + random.direction()).normalized();
        const Step step = guard.step({.tip = tip, .desired = drag});
        if (cycle >= 40) motions.push_back({.tip = tip, .desired = drag});
        tip += step.motion;
      }
    }
  }
};

const Scene& scene() {
  static const Scene only;
  return only;
}

/// The same steps, bit for bit, as with brute force on a sample of the motions.
bool agrees_with_brute_force(MotionConstraint& constraint, MotionConstraintSettings settings) {
  settings.index = "brute_force";
  MotionConstraint oracle = make_motion_constraint(scene().mesh, settings);
  for (std::size_t i = 0; i < scene().motions.size(); i += 400) {
    const Motion& motion = scene().motions[i];
    const Step expected = oracle.step(motion);
    const Step got = constraint.step(motion);
    if (got.status != expected.status || got.motion != expected.motion) return false;
  }
  return true;
}

void step(benchmark::State& state, const MotionConstraintSettings& settings) {
  MotionConstraint constraint = make_motion_constraint(scene().mesh, settings);
  if (!agrees_with_brute_force(constraint, settings)) {
    state.SkipWithError("not the steps of brute force");
    return;
  }
  std::vector<double> microseconds;
  std::size_t planes = 0, triangles = 0;
  for (auto _ : state) {
    const Motion& motion = scene().motions[microseconds.size() % scene().motions.size()];
    StageTimes times;
    const Step result = constraint.step(motion, times);
    benchmark::DoNotOptimize(result.motion);
    planes += result.planes.size();
    triangles += result.triangles;
    microseconds.push_back(1e-3 * static_cast<double>(times.total()));
  }
  std::sort(microseconds.begin(), microseconds.end());
  const auto count = static_cast<double>(microseconds.size());
  const auto at = [&](double share) {
    return microseconds[static_cast<std::size_t>(share * (count - 1))];
  };
  state.counters["p50_us"] = at(0.5);
  state.counters["p99_us"] = at(0.99);
  state.counters["p999_us"] = at(0.999);
  state.counters["planes"] = static_cast<double>(planes) / count;
  state.counters["triangles"] = static_cast<double>(triangles) / count;
}

void register_step(const std::string& index, const std::string& rule, double radius,
                   double tool_radius, int nodes) {
  const MotionConstraintSettings settings{.index = index,
                                          .activation = rule,
                                          .radius = radius,
                                          .tool_radius = tool_radius,
                                          .margin = margin,
                                          .nodes = nodes,
                                          .inside = Inside::taken_as_is};
  std::ostringstream name;
  name << "step/" << index << '/' << rule << '/' << settings.solver << "/skull_1m/r=" << radius;
  if (tool_radius > 0.0) name << "/tool=" << tool_radius;
  if (nodes > 0) name << "/nodes=" << nodes;
  benchmark::RegisterBenchmark(name.str().c_str(), [settings](benchmark::State& state) {
    step(state, settings);
  })->Unit(benchmark::kMicrosecond);
}

void register_steps() {
  for (const IndexBackend& entry : index_backends()) {
    if (entry.name == "brute_force") continue;  // the oracle: tens of milliseconds a step
    const std::string index(entry.name);
    for (const double radius : {1.0, 5.0}) {
      register_step(index, "all_faces", radius, 0.0, 0);
      register_step(index, "paper", radius, 0.0, 0);
    }
    register_step(index, "certified", 5.0, 0.0, 0);
    register_step(index, "certified", 5.0, 0.0, 16);
    register_step(index, "certified", 5.0, 1.0, 0);
  }
}

const bool registered = (register_steps(), true);

}  // namespace
}  // namespace keepout
