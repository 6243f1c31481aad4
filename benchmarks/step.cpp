// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
// One step in contact: each rule, at several radii of the motion sphere. An index that disagrees
// with brute force is not timed.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/adapters/load_mesh.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/real_mesh.h"

namespace keepout {
namespace {

struct Scene {
  std::shared_ptr<const Mesh> mesh = load_mesh(fixture_path("skull")).mesh;
  std::vector<Motion> motions;

  Scene() {
    Random random(1);
    for (const Vec3& tip : surface_points(*mesh, 2000, 0.05, random)) {
      motions.push_back({.tip = tip, .desired = 0.2 * random.direction()});
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
  for (std::size_t i = 0; i < scene().motions.size(); i += 200) {
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

void register_steps() {
  for (const IndexBackend& index : index_backends()) {
    if (index.name == "brute_force") continue;  // the oracle: tens of milliseconds a step
    for (const ActivationEntry& rule : activation_rules()) {
      for (const double radius : {0.25, 1.0, 5.0}) {
        const MotionConstraintSettings settings{.index = std::string(index.name),
                                                .activation = std::string(rule.name),
                                                .radius = radius};
        std::ostringstream name;
        name << "step/" << settings.index << '/' << settings.activation << '/' << settings.solver
             << "/skull/r=" << radius;
        benchmark::RegisterBenchmark(name.str().c_str(), [settings](benchmark::State& state) {
          step(state, settings);
        })->Unit(benchmark::kMicrosecond);
      }
    }
  }
}

const bool registered = (register_steps(), true);

}  // namespace
}  // namespace keepout
