// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
// One step(), used twice: composed of final types, where the compiler sees every call through, and
// behind the run-time facade, which takes its parts by name. The motions are the same, bit for bit.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <vector>

#include "keepout/activation/certified.h"
#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/error.h"
#include "keepout/index/wide_bvh.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/solvers/active_set.h"
#include "keepout/solvers/registry.h"
#include "keepout/step/motion_constraint.h"

using MeshPtr = std::shared_ptr<const keepout::Mesh>;

/// The parts by value. What satisfies the concepts fits, derived from our interfaces or not; with
/// final types step() has no virtual call left. It does not ask which side of the mesh the tip is
/// on.
template <keepout::Index I, keepout::ActivationRule A, keepout::QpSolver S>
class StaticGuard {
 public:
  StaticGuard(const MeshPtr& mesh, const keepout::StepOptions& options)
      : mesh_(mesh), index_(mesh), rule_(mesh), options_(options), work_(capacity) {
    rule_.reserve(capacity.triangles);
    solver_.reserve(3, static_cast<int>(capacity.planes));
  }

  keepout::Step step(const keepout::Motion& motion) noexcept {
    return keepout::step(*mesh_, index_, rule_, solver_, motion, options_, work_);
  }

 private:
  static constexpr keepout::Capacity capacity{
      .triangles = 1 << 14, .planes = 1 << 10, .extra_rows = 0};

  MeshPtr mesh_;
  I index_;
  A rule_;
  S solver_;
  keepout::StepOptions options_;
  keepout::Workspace work_;
};

/// The same parts by name, behind their interfaces.
keepout::MotionConstraint facade(const MeshPtr& mesh, const keepout::StepOptions& options) {
  return {mesh, keepout::make_index("wide_bvh", mesh), keepout::make_activation("certified", mesh),
          keepout::make_solver("active_set"), options};
}

/// All motions on the way down from above and along the surface, and the time of a step. [us]
struct Run {
  std::vector<keepout::Vec3> motions;
  double time = 1e9;
};

template <class Guard>
void drive(Guard& guard, const keepout::Mesh& mesh, Run& run) {
  constexpr int cycles = 2000;
  keepout::Vec3 tip(mesh.bounds().center());
  tip.z() = mesh.bounds().high.z() + 2.0;
  run.motions.resize(cycles);
  const auto start = std::chrono::steady_clock::now();
  for (keepout::Vec3& motion : run.motions) {
    motion = guard.step({.tip = tip, .desired = {0.01, 0.0, -0.02}}).motion;
    tip += motion;
  }
  const std::chrono::duration<double, std::micro> spent = std::chrono::steady_clock::now() - start;
  run.time = std::min(run.time, spent.count() / cycles);
}

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s MESH\n", argv[0]);
    return 2;
  }
  const MeshPtr mesh = keepout::load_mesh(argv[1]).mesh;
  keepout::StepOptions options{.radius = 2.0, .margin = 0.5, .searching = false};
  StaticGuard<keepout::WideBvh, keepout::CertifiedRule, keepout::ActiveSet> composed(mesh, options);
  auto by_name = facade(mesh, options);
  options.searching = true;  // the default: the rule walks the index by itself
  auto searching = facade(mesh, options);

  Run of_composed, of_named, of_searching;
  for (int pass = 0; pass < 20; ++pass) {  // the best of several, in turn
    drive(composed, *mesh, of_composed);
    drive(by_name, *mesh, of_named);
    drive(searching, *mesh, of_searching);
  }
  int different = 0;
  for (std::size_t i = 0; i < of_named.motions.size(); ++i) {
    different += of_composed.motions[i] != of_named.motions[i];
    different += of_composed.motions[i] != of_searching.motions[i];
  }
  std::printf("%d motions differ; a step takes %.2f us composed, %.2f by name, %.2f searching\n",
              different, of_composed.time, of_named.time, of_searching.time);
  return different == 0 ? 0 : 1;
} catch (const keepout::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
