// SPDX-License-Identifier: BSD-3-Clause
// Measures how much worse the certified step is than the best possible step: excess = (cost - best
// cost) / length of the desired increment.

#include <numeric>

#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/poses.h"
#include "keepout/fixtures/real_mesh.h"
#include "keepout/index/pd_tree.h"
#include "keepout/index/query.h"
#include "keepout/mesh/load_mesh.h"
#include "keepout/oracle/best_step.h"
#include "meshes.h"
#include "trials.h"

namespace keepout::test {
namespace {

using oracle::best_step;
using oracle::BestStep;

/// A tip in or near contact, its desired increment, and the cost of the best step.
struct State {
  Vec3 tip;
  Vec3 desired;
  double best_cost;
  double bound;  // no safe step costs less
};

struct Scene {
  std::shared_ptr<const Mesh> mesh;
  double margin;
  double radius;
  std::vector<State> states;
};

double mean_edge(const Mesh& mesh) {
  double sum = 0.0;
  const std::size_t count = std::min<std::size_t>(mesh.triangle_count(), 2000);
  for (TriangleId t = 0; t < count; ++t) {
    const Triangle triangle = mesh.triangle(t);
    sum += (triangle[1] - triangle[0]).norm();
  }
  return sum / static_cast<double>(count);
}

MotionConstraint guard(const Scene& scene, int refinements, int nodes) {
  return make_motion_constraint(scene.mesh, {.options = {.radius = scene.radius,
                                                         .margin = scene.margin,
                                                         .refinements = refinements,
                                                         .nodes = nodes},
                                             .inside = Inside::taken_as_is});
}

/// Returns states with steps in all directions, 0.1 to 10 edges long. Each tip has first been
/// pushed against the surface. About half of the steps are free.
Scene make_scene(std::shared_ptr<const Mesh> mesh, std::size_t count) {
  const double edge = mean_edge(*mesh);
  Scene scene{.mesh = mesh, .margin = 1e-2 * edge, .radius = 20.0 * edge, .states = {}};
  MotionConstraint pusher = guard(scene, 3, 0);
  const PdTree tree(mesh);
  NearestTriangle nearest(*mesh, tree);
  TriangleBuffer near(mesh->triangle_count());
  Random random(11);
  while (scene.states.size() < count) {
    Vec3 tip = surface_points(*mesh, 1, 0.5 * edge, random).front();
    const Vec3 to_surface = nearest(tip).closest.offset;
    const Vec3 push = 3.0 * edge * (to_surface.normalized() + random.direction()).normalized();
    for (int i = 0; i < 3; ++i) tip += pusher.step({.tip = tip, .desired = push}).motion;
    const Vec3 desired = edge * std::pow(10.0, random.uniform(-1.0, 1.0)) * random.direction();
    const Step step = pusher.step({.tip = tip, .desired = desired});
    if (step.status == Status::recovering) continue;
    if (step.status == Status::free) {
      scene.states.push_back({tip, desired, 0.0, 0.0});
      continue;
    }
    near.clear();
    tree.collect({tip + 0.5 * desired, 0.5 * desired.norm() + 1.001 * scene.margin}, near);
    const BestStep best = best_step(*mesh, near.view(), tip, desired, scene.margin);
    scene.states.push_back({tip, desired, best.cost, best.bound});
  }
  return scene;
}

struct Excess {
  double mean, p95, worst;
  double limited;       // fraction of steps that are not free
  double limited_mean;  // mean excess of these steps
  std::size_t stuck;    // steps without motion, with a best cost below 95 % of the increment
};

Excess excess_of(const Scene& scene, int refinements, int nodes) {
  MotionConstraint constraint = guard(scene, refinements, nodes);
  std::vector<double> excess;
  std::size_t stuck = 0, limited = 0;
  for (const State& state : scene.states) {
    const Step step = constraint.step({.tip = state.tip, .desired = state.desired});
    EXPECT_TRUE(step.ok()) << step.reason();
    const double length = state.desired.norm();
    const double cost = (step.motion - state.desired).norm();
    EXPECT_GE(cost, state.bound - 1e-6 * length)
        << "below the oracle's bound: one of the two is wrong";
    excess.push_back((cost - state.best_cost) / length);
    limited += step.status != Status::free;
    stuck += step.motion.norm() < 1e-6 * length && state.best_cost < 0.95 * length;
  }
  std::sort(excess.begin(), excess.end());
  const double sum = std::accumulate(excess.begin(), excess.end(), 0.0);
  const auto count = static_cast<double>(excess.size());
  return {.mean = sum / count,
          .p95 = excess[excess.size() * 95 / 100],
          .worst = excess.back(),
          .limited = static_cast<double>(limited) / count,
          .limited_mean = sum / static_cast<double>(limited),
          .stuck = stuck};
}

class CertifiedExcess : public testing::TestWithParam<std::string> {};

TEST_P(CertifiedExcess, IsSmallAndNoUsefulMotionIsMissed) {
  const std::string name = GetParam();
  const std::shared_ptr<const Mesh> mesh =
      name == "skull" ? load_mesh(fixture_path("skull")).mesh : mesh_of(name);
  const Scene scene = make_scene(mesh, 600);
  const Excess plain = excess_of(scene, 0, 0);
  const Excess refined = excess_of(scene, 3, 0);
  const Excess searched = excess_of(scene, 3, 16);
  for (const auto& [kind, excess] :
       {std::pair{"K0", plain}, std::pair{"K3", refined}, std::pair{"K3_nodes16", searched}}) {
    RecordProperty(std::string(kind) + "_mean", std::to_string(excess.mean));
    RecordProperty(std::string(kind) + "_p95", std::to_string(excess.p95));
    RecordProperty(std::string(kind) + "_worst", std::to_string(excess.worst));
    RecordProperty(std::string(kind) + "_limited", std::to_string(excess.limited));
    RecordProperty(std::string(kind) + "_limited_mean", std::to_string(excess.limited_mean));
    EXPECT_EQ(excess.stuck, 0u) << kind;
  }
  const auto digits = [](double x) { return std::round(1e4 * x) / 1e4 + 0.0; };  // no -0.0000
  std::printf(
      "| mesh | K = 0 | K = 3 | K = 3, 16 nodes | p95, K = 3 | worst, K = 3 |\n"
      "|---|--:|--:|--:|--:|--:|\n"
      "| %s | %.4f (%.4f) | %.4f (%.4f) | %.4f (%.4f) | %.4f | %.2f |\n",
      name.c_str(), digits(plain.mean), digits(plain.limited_mean), digits(refined.mean),
      digits(refined.limited_mean), digits(searched.mean), digits(searched.limited_mean),
      digits(refined.p95), refined.worst);
  EXPECT_LE(refined.mean, 0.003);
  EXPECT_LE(refined.p95, 0.01);
  EXPECT_LE(refined.mean, plain.mean + 1e-9);
  EXPECT_LE(refined.limited_mean, 0.006);
  EXPECT_LE(searched.mean, 0.002);
  EXPECT_GE(refined.limited, 0.25) << "too few limited steps for a meaningful test";
  EXPECT_LE(searched.mean, refined.mean + 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Meshes, CertifiedExcess,
                         testing::Values("cube", "sphere", "gear", "skull", "cortex"), by_name);

}  // namespace
}  // namespace keepout::test
