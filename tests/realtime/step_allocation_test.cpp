// SPDX-License-Identifier: BSD-3-Clause
#include <set>

#include "engine/geometry/tools.h"
#include "keepout/activation/convex_tool_rule.h"
#include "keepout/activation/registry.h"
#include "keepout/adapters/index_registry.h"
#include "keepout/factory/convex_tool_text.h"
#include "keepout/factory/guide_text.h"
#include "keepout/factory/make_motion_constraint.h"
#include "keepout/fixtures/poses.h"
#include "keepout/index/pd_tree.h"
#include "keepout/solvers/active_set.h"
#include "keepout/solvers/registry.h"
#include "keepout/step/motion_constraint.h"
#include "meshes.h"
#include "messages.h"
#include "realtime/counted_allocations.h"

namespace keepout {
namespace {

TEST(Allocations, AreCounted) {
  const std::size_t before = allocations();
  const auto made = std::make_unique<std::vector<double>>(10);
  EXPECT_EQ(allocations(), before + 2);
  const Eigen::MatrixXd matrix = Eigen::MatrixXd::Ones(5, static_cast<int>(made->size()));
  EXPECT_EQ(allocations(), before + 3) << matrix.sum();
}

/// Returns the outcomes that must occur, so that all paths of a rule are covered.
std::set<Status> outcomes_of(std::string_view rule, std::string_view index) {
  std::set<Status> all{Status::free, Status::limited, Status::ill_posed, Status::invalid_input,
                       Status::beyond_reach};
  // On a wide_bvh this rule traverses the index, and needs no capacity for all triangles in reach.
  const bool searches = rule == "certified" && index == "wide_bvh";
  if (!searches) all.insert(Status::over_capacity);
  if (rule == "certified") {
    all.insert({Status::recovering, Status::touching});
    // With brute force all triangles are candidates, however short the motion is.
    if (!searches && index != "brute_force") all.insert(Status::truncated);
  } else {
    all.insert(Status::infeasible);
  }
  return all;
}

TEST(Step, AllocatesNothingWhateverItsPartsAndItsOutcome) {
  const auto mesh = mesh_of("cortex");
  const auto plates = mesh_of("thin_plates");
  const auto tunnel = mesh_of("tunnel");
  const Vec3 in_the_gap(0, 0, plates->bounds().low.z() + 1.5);
  Random random(1);
  const std::vector<Vec3> tips = surface_points(*mesh, 60, 0.5, random);
  Eigen::Matrix<double, 3, Eigen::Dynamic> jacobian(3, 7);
  for (int i = 0; i < jacobian.size(); ++i) jacobian.data()[i] = normal(random);
  Eigen::Matrix<double, 6, 7, Eigen::RowMajor> of_a_frame;
  of_a_frame << jacobian, jacobian;
  const std::vector<double> limits(14, -1.0);
  const std::vector<double> rows(14 * 7, 0.1);

  for (const IndexBackend& index : index_backends()) {
    if (index.allocation != Allocation::never) continue;  // see Index.OnlyFclsOwnQueryAllocates
    for (const ActivationEntry& rule : activation_rules()) {
      for (const SolverBackend& solver : solver_backends()) {
        if (solver.allocation != Allocation::never) continue;
        SCOPED_TRACE(std::string(index.name) + " " + std::string(rule.name) + " " +
                     std::string(solver.name));
        const MotionConstraintSettings settings{
            .index = std::string(index.name),
            .activation = std::string(rule.name),
            .solver = std::string(solver.name),
            .options = {.radius = 4.0, .margin = 0.1, .damping = 1e-6, .nodes = 8}};
        MotionConstraint constraint = make_motion_constraint(mesh, settings);
        MotionConstraintSettings with_distances = settings;
        with_distances.options.distances = Distances::always;
        MotionConstraint telling = make_motion_constraint(mesh, with_distances);
        MotionConstraintSettings ill_posed = settings;
        ill_posed.options.damping = 0.0;
        ill_posed.capacity.triangles = 1;
        ill_posed.inside = Inside::taken_as_is;  // the capacity is too small for the classification
        MotionConstraint small = make_motion_constraint(mesh, ill_posed);
        // Motions are halved until the triangles in reach fit the capacity.
        MotionConstraintSettings narrow = settings;
        narrow.capacity.triangles = 8;
        narrow.inside = Inside::taken_as_is;
        MotionConstraint halving = make_motion_constraint(mesh, narrow);
        // Between two plates, closer to both than the margin allows.
        MotionConstraintSettings thick = settings;
        thick.options.radius = 2.0;
        thick.options.margin = 0.75;
        MotionConstraint wide = make_motion_constraint(plates, thick);
        MotionConstraint open = make_motion_constraint(tunnel, settings);
        const Vec3 on_the_tunnel = tunnel->vertex(0);
        std::vector<Status> seen;
        seen.reserve(16 * tips.size());
        std::size_t planes = 0;
        const std::size_t before = allocations();
        for (const Vec3& tip : tips) {
          StageTimes times;
          const Vec3 desired = random.direction() * 2.0;
          const ExtraRows extra(rows.data(), limits.data(), 14);
          const auto take = [&](MotionConstraint& guard, const Motion& motion) {
            seen.push_back(guard.step(motion).status);
          };
          seen.push_back(constraint.step({.tip = tip, .desired = desired}, times).status);
          take(constraint, {.tip = tip, .desired = -10.0 * desired});
          take(constraint, {.tip = tip});
          take(constraint, {.tip = tip, .desired = desired, .jacobian = jacobian});
          take(constraint, {.tip = tip, .desired = desired, .jacobian = jacobian, .rows = extra});
          take(constraint, {.tip = tip, .desired = desired, .jacobian = of_a_frame.topRows<3>()});
          take(telling, {.tip = tip, .desired = desired});
          take(telling, {.tip = 3.0 * tip, .desired = desired});
          take(constraint, {.tip = 0.9 * tip, .desired = desired});  // some of these are inside
          take(small, {.tip = tip, .desired = desired, .jacobian = jacobian});
          take(small, {.tip = tip + Vec3(0, 0, 100), .desired = desired, .jacobian = jacobian});
          take(halving, {.tip = tip, .desired = 1.9 * desired});
          take(wide, {.tip = in_the_gap, .desired = 0.1 * desired});
          take(wide, {.tip = 2.0 * tip, .desired = 0.1 * desired, .jacobian = jacobian});
          take(open, {.tip = on_the_tunnel, .desired = desired});
          planes += constraint.free_polytope(tip, 2.0).planes.size();
        }
        EXPECT_EQ(allocations(), before);
        EXPECT_GT(planes, 0u);
        const std::set<Status> outcomes(seen.begin(), seen.end());
        for (const Status status : outcomes_of(rule.name, index.name)) {
          EXPECT_TRUE(outcomes.contains(status)) << name(status);
        }
      }
    }
  }
}

TEST(Step, AllocatesNothingWithGuides) {
  const auto mesh = mesh_of("cortex");
  Random random(2);
  const std::vector<Vec3> tips = surface_points(*mesh, 60, 0.5, random);
  Eigen::Matrix<double, 3, 7> jacobian;
  for (int i = 0; i < jacobian.size(); ++i) jacobian.data()[i] = normal(random);
  const Eigen::Matrix<double, 3, 8> too_many = Eigen::Matrix<double, 3, 8>::Ones();
  for (const IndexBackend& index : index_backends()) {
    if (index.allocation != Allocation::never) continue;
    SCOPED_TRACE(std::string(index.name));
    MotionConstraint guard =
        make_motion_constraint(mesh, {.index = std::string(index.name),
                                      .options = {.radius = 4.0, .margin = 0.1, .damping = 1e-6}});
    std::set<Status> seen;
    int limited = 0;
    int relaxed = 0;
    for (std::size_t i = 0; i < tips.size(); ++i) {
      const Vec3& tip = tips[i];
      const Vec3 way = random.direction();
      std::vector<Guide> guides{Guide::point("corridor", Region::slab(tip, way, 0.3)),
                                Guide::point("ball", Region::ball(tip, 0.5))};
      if (i % 2 == 0) {  // the tip is outside two regions that have no point in common
        const Vec3 x = Vec3::UnitX();
        guides.push_back(Guide::point("one", Region::half_space(tip + 0.1 * x, x)));
        guides.push_back(Guide::point("other", Region::half_space(tip - 0.1 * x, -x)));
      }
      guard.set_guides(guides);
      const Vec3 desired = 2.0 * random.direction();
      const Motion motions[] = {{.tip = tip, .desired = desired},
                                {.tip = tip, .desired = desired, .jacobian = jacobian},
                                {.tip = tip, .desired = desired, .jacobian = too_many},
                                {.tip = tip, .desired = 10.0 * desired}};
      Status status[4] = {};
      const std::size_t before = allocations();
      for (std::size_t m = 0; m < 4; ++m) {
        const Step step = guard.step(motions[m]);
        status[m] = step.status;
        limited += step.limits.has(Limit::guide) ? 1 : 0;
        relaxed += step.relaxation == Relaxation::guides ? 1 : 0;
      }
      EXPECT_EQ(allocations(), before);
      seen.insert(std::begin(status), std::end(status));
    }
    EXPECT_GT(limited, 20);
    EXPECT_GT(relaxed, 20);
    for (const Status status :
         {Status::limited, Status::recovering, Status::over_capacity, Status::beyond_reach}) {
      EXPECT_TRUE(seen.contains(status)) << name(status);
    }
  }
}

TEST(ConvexToolAllocation, AStepAllocatesNothingWhateverItsOutcome) {
  const auto mesh = std::make_shared<const Mesh>(make_shape("cortex"));
  Random random(1);
  for (const test::NamedTool& named : test::tools_of_each_kind(2.0, random)) {
    MotionConstraint constraint(mesh, std::make_unique<PdTree>(mesh),
                                std::make_unique<ConvexToolRule>(named.tool),
                                std::make_unique<ActiveSet>(), {.radius = 2.0, .margin = 0.3});
    const double reach = named.tool.bounding_ball().center.norm() + named.tool.radius();
    std::size_t of_each[16] = {};
    for (const double offset : {0.2, 0.6, reach, 1.5 * reach + 1.0, 8.0}) {
      const std::vector<Vec3> tips = surface_points(*mesh, 100, offset, random);
      const std::size_t before = allocations();
      for (const Vec3& tip : tips) {
        const Vec3 desired = 1.9 * random.direction();
        ++of_each[static_cast<std::size_t>(
            constraint.step({.tip = tip, .desired = desired}).status)];
      }
      EXPECT_EQ(allocations(), before) << named.name;
    }
    for (const Status status :
         {Status::free, Status::limited, Status::recovering, Status::touching}) {
      EXPECT_GT(of_each[static_cast<std::size_t>(status)], 0u) << named.name << name(status);
    }
  }
}

TEST(ConvexToolAllocation, AStepAsSimulateMakesItAllocatesNothing) {
  const auto mesh = mesh_of("cortex");
  MotionConstraint constraint = make_motion_constraint(
      mesh, {.options = {.radius = 2.0, .margin = 0.3}, .tool = tool_of_text("blade:6:2:0.5")});
  Random random(3);
  int limited = 0;
  int guided = 0;
  for (Vec3 tip : surface_points(*mesh, 30, 4.0, random)) {
    const std::vector<Guide> guides{
        guide_of_text("slab:0,0," + std::to_string(tip.z()) + ":0,0,1:0.5")};
    constraint.set_guides(guides);
    const Vec3 desired = 0.5 * random.direction();
    const std::size_t before = allocations();
    for (int cycle = 0; cycle < 50; ++cycle) {
      StageTimes times;
      const Step step = constraint.step({.tip = tip, .desired = desired}, times);
      tip += step.motion;
      limited += step.status == Status::limited ? 1 : 0;
      guided += step.limits.has(Limit::guide) ? 1 : 0;
    }
    EXPECT_EQ(allocations(), before);
  }
  EXPECT_GT(limited, 100);
  EXPECT_GT(guided, 100);
}

// An index does not allocate during a query, unless its table entry says so.

TEST(Index, AllocatesNothingWhileItAnswersUnlessItSaysSo) {
  const auto mesh = mesh_of("cortex");
  const double size = mesh->bounds().size().norm();
  Random random(6);
  std::vector<Vec3> points = surface_points(*mesh, 100, 0.5, random);
  const std::vector<Vec3> far = far_points(*mesh, 20, random);
  points.insert(points.end(), far.begin(), far.end());
  for (const IndexBackend& backend : index_backends()) {
    SCOPED_TRACE(backend.name);
    const std::unique_ptr<SpatialIndex> index = backend.make(mesh);
    TriangleBuffer candidates(mesh->triangle_count());
    std::size_t found = 0;
    const std::size_t before = allocations();  // the first query counts, too
    for (const Vec3& point : points) {
      for (const double radius : {0.0, 1.0, 10.0, size, 1e6 * size}) {
        candidates.clear();
        index->collect({point, radius}, candidates);
        found += candidates.size();
      }
    }
    if (backend.allocation == Allocation::never) {
      EXPECT_EQ(allocations(), before);
    } else {
      EXPECT_GT(allocations(), before) << "is fit for real time: its row may say so";
      EXPECT_CONTAINS(backend.description, "not for real time");
    }
    EXPECT_GT(found, points.size() * mesh->triangle_count());
  }
}

TEST(Index, OnlyFclsOwnQueryAllocates) {
  for (const IndexBackend& backend : index_backends()) {
    EXPECT_EQ(backend.allocation == Allocation::inside, backend.name == "fcl_collide")
        << backend.name;
  }
}

}  // namespace
}  // namespace keepout
