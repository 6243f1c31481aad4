// SPDX-License-Identifier: BSD-3-Clause
// Problems whose rows come from planes. Reading the planes gives the same solution as reading the
// rows, on every SIMD target.

#include "keepout/solvers/active_set.h"
#include "keepout/testing/solver_trials.h"
#include "unit_planes.h"

namespace keepout::test {
namespace {

/// A problem whose first rows come from planes.
struct PlaneProblem {
  Problem problem;
  std::vector<HalfSpace> planes;

  /// Returns the problem with its rows, without planes.
  StepProblem as_rows() const { return problem.view(); }

  /// Returns the problem with its planes. Their rows are NaN, so a solver must not read them.
  StepProblem as_planes() {
    const auto count = static_cast<Eigen::Index>(planes.size());
    unwritten = problem;
    unwritten.rows.topRows(count).setConstant(nan);
    unwritten.bounds.head(count).setConstant(nan);
    StepProblem view = unwritten.view();
    view.planes = planes;
    return view;
  }

  Problem unwritten;
};

/// Returns a problem of a point, or of joints with limits.
PlaneProblem plane_problem(Planes kind, int n, int m, Random& random) {
  PlaneProblem posed;
  Problem around;
  const Eigen::VectorXd inside = 0.3 * random.vector(n);
  posed.problem.jacobian = n == 3 ? StepProblem::Matrix::Identity(3, 3) : random.matrix(3, n);
  posed.problem.desired = random.vector(3);
  posed.problem.damping = n == 3 ? 0.0 : 1e-3;
  make_planes(around, kind, posed.problem.jacobian * inside, m, random);
  const int limits = n == 3 ? 0 : 2 * n;
  posed.problem.rows.setZero(m + limits, n);
  posed.problem.bounds.setConstant(m + limits, -1.5);
  for (int i = 0; i < m; ++i) {
    const double norm = around.rows.row(i).norm();
    const Vec3 normal = around.rows.row(i).transpose() / norm;
    posed.planes.push_back({normal, around.bounds[i] / norm, static_cast<TriangleId>(i)});
    write_row(normal, posed.problem.jacobian.data(), n, posed.problem.rows.row(i).data());
    posed.problem.bounds[i] = posed.planes.back().offset;
  }
  for (int i = 0; i < limits; ++i) posed.problem.rows(m + i, i / 2) = i % 2 == 0 ? 1 : -1;
  return posed;
}

struct Answer {
  SolveStatus status;
  Eigen::VectorXd u;
  std::vector<double> multipliers;
  std::vector<std::uint32_t> active;

  bool operator==(const Answer&) const = default;
};

class ActiveSetPlanes : public testing::Test {
 protected:
  void SetUp() override { solver_.reserve(8, 2000); }

  Answer solve(const StepProblem& problem) {
    Answer answer;
    answer.status = solver_.solve(problem, solution_);
    answer.u = vector(solution_.u);
    answer.multipliers.assign(solution_.multipliers.begin(), solution_.multipliers.end());
    answer.active.assign(solution_.active.begin(), solution_.active.end());
    return answer;
  }

  ActiveSet solver_;
  Solution solution_;
};

constexpr std::array counts = {0, 1, 2, 3, 7, 8, 10, 16, 17, 24, 40, 100, 333};

TEST(UnitPlanes, TheMostViolatedIsThatOfALoopOnEveryTarget) {
  active_set::UnitPlanes listed;
  listed.reserve(200);
  for (int i = 0; i < 2000; ++i) {
    Random random(static_cast<std::uint64_t>(i));
    const int m = random.integer(0, 200);
    std::vector<Vec3> normals;
    std::vector<double> offsets;
    listed.clear();
    const Vec3 point = random.vector(3);
    active_set::Violated expected;
    for (int row = 0; row < m; ++row) {
      const bool again = row > 0 && random.integer(0, 3) == 0;  // ties
      const int of = again ? random.integer(0, row - 1) : 0;
      normals.push_back(again ? normals[static_cast<std::size_t>(of)] : Vec3(random.direction(3)));
      offsets.push_back(again ? offsets[static_cast<std::size_t>(of)] : random.uniform(-1, 1));
      listed.push(normals.back().data(), offsets.back());
      const double by = active_set::missing(normals.back().data(), offsets.back(), point.data());
      if (by > expected.by) expected = {row, by};
    }
    listed.close();
    on_each_simd_target([&] {
      const active_set::Violated got = listed.most_violated(point.data());
      ASSERT_EQ(got.row, expected.row) << "seed " << i;
      ASSERT_EQ(got.by, expected.by) << "seed " << i;
    });
  }
}

TEST_F(ActiveSetPlanes, APointIsMovedTheSameToTheLastBitFromPlanesAndFromRows) {
  for (const Planes kind : plane_kinds) {
    for (int i = 0; i < 260; ++i) {
      Random random(static_cast<std::uint64_t>(i) * 10 + static_cast<std::uint64_t>(kind));
      const int m = counts[static_cast<std::size_t>(i) % counts.size()];
      PlaneProblem posed = plane_problem(kind, 3, m, random);
      const Answer from_rows = solve(posed.as_rows());
      ASSERT_EQ(from_rows.status, SolveStatus::optimal) << name(kind) << ", seed " << i;
      EXPECT_LT(kkt_residual(posed.as_rows(), solution_).worst(), 1e-10)
          << name(kind) << ", seed " << i;
      on_each_simd_target([&] {
        EXPECT_TRUE(solve(posed.as_planes()) == from_rows) << name(kind) << ", seed " << i;
        EXPECT_TRUE(solve(posed.as_rows()) == from_rows) << name(kind) << ", seed " << i;
      });
    }
  }
}

TEST_F(ActiveSetPlanes, JointsAreMovedTheSameFromPlanesAndFromRows) {
  int posed_in_all = 0;
  for (const Planes kind : {Planes::scattered, Planes::touching, Planes::redundant}) {
    for (int i = 0; i < 390; ++i) {
      Random random(static_cast<std::uint64_t>(i) * 10 + static_cast<std::uint64_t>(kind));
      const int m = counts[static_cast<std::size_t>(i) % counts.size()];
      PlaneProblem posed = plane_problem(kind, random.integer(4, 8), m, random);
      const Answer from_rows = solve(posed.as_rows());
      const Answer expected = solve(posed.as_planes());
      ASSERT_EQ(expected.status, from_rows.status) << name(kind) << ", seed " << i;
      if (from_rows.status != SolveStatus::optimal) continue;
      EXPECT_LT(kkt_residual(posed.as_rows(), solution_).worst(), 1e-9)
          << name(kind) << ", seed " << i;
      EXPECT_LT((expected.u - from_rows.u).norm(), 1e-9 * (1 + from_rows.u.norm()))
          << name(kind) << ", seed " << i;
      if (kind != Planes::touching) {  // else any three of many planes are as good
        EXPECT_EQ(expected.active, from_rows.active) << name(kind) << ", seed " << i;
      }
      ++posed_in_all;
      on_each_simd_target([&] {
        EXPECT_TRUE(solve(posed.as_planes()) == expected) << name(kind) << ", seed " << i;
      });
    }
  }
  EXPECT_GT(posed_in_all, 1000);
}

TEST_F(ActiveSetPlanes, JointsThatAllButLackADirectionAreMovedByRows) {
  for (const double weak : {1e-2, 1e-5, 1e-9, 0.0}) {
    for (int i = 0; i < 100; ++i) {
      Random random(static_cast<std::uint64_t>(i) + 5000);
      PlaneProblem posed = plane_problem(Planes::scattered, 7, 0, random);
      posed.problem.jacobian.row(2) *= weak;
      for (int p = 0; p < 20; ++p) {
        const Vec3 normal = random.direction(3);
        posed.planes.push_back({normal, -random.uniform(0, 0.5), static_cast<TriangleId>(p)});
      }
      const Problem limits = posed.problem;
      posed.problem.rows.resize(20 + limits.rows.rows(), 7);
      posed.problem.bounds.resize(20 + limits.rows.rows());
      for (int p = 0; p < 20; ++p) {
        const HalfSpace& plane = posed.planes[static_cast<std::size_t>(p)];
        write_row(plane.normal, posed.problem.jacobian.data(), 7, posed.problem.rows.row(p).data());
        posed.problem.bounds[p] = plane.offset;
      }
      posed.problem.rows.bottomRows(limits.rows.rows()) = limits.rows;
      posed.problem.bounds.tail(limits.bounds.size()) = limits.bounds;
      const Answer from_rows = solve(posed.as_rows());
      ASSERT_EQ(from_rows.status, SolveStatus::optimal) << weak << ", seed " << i;
      EXPECT_TRUE(solve(posed.as_planes()) == from_rows) << weak << ", seed " << i;
    }
  }
}

TEST_F(ActiveSetPlanes, WhereNothingIsInTheWayTheAnswerIsWhatWasAskedForToTheLastBit) {
  for (const int m : counts) {
    Random random(static_cast<std::uint64_t>(m));
    PlaneProblem posed = plane_problem(Planes::scattered, 3, m, random);
    for (HalfSpace& plane : posed.planes) plane.offset = -10;
    const Answer answer = solve(posed.as_planes());
    ASSERT_EQ(answer.status, SolveStatus::optimal) << m;
    EXPECT_EQ(answer.u, posed.problem.desired) << m;
    EXPECT_TRUE(answer.active.empty()) << m;
    EXPECT_EQ(solution_.iterations, 0) << m;
  }
}

TEST_F(ActiveSetPlanes, PlanesThatContradictEachOtherAreInfeasible) {
  for (int i = 0; i < 400; ++i) {
    Random random(static_cast<std::uint64_t>(i) + 9000);
    PlaneProblem posed = plane_problem(Planes::scattered, i % 2 == 0 ? 3 : 7, 30, random);
    const double apart = random.log_uniform(1e-6, 1);
    posed.planes[7] = {-posed.planes[3].normal, -posed.planes[3].offset + apart, 7};
    EXPECT_EQ(solve(posed.as_planes()).status, SolveStatus::infeasible) << "seed " << i;
    posed.planes.resize(8);
    posed.problem.rows.conservativeResize(8, Eigen::NoChange);
    posed.problem.bounds.conservativeResize(8);
    EXPECT_EQ(solve(posed.as_planes()).status, SolveStatus::infeasible) << "seed " << i;
  }
}

TEST_F(ActiveSetPlanes, PlanesThatAreNoneAreRefused) {
  for (const int n : {3, 7}) {
    for (const int m : {5, 40}) {
      for (const double bad : {nan, infinity, -infinity, 1e200}) {
        Random random(1);
        PlaneProblem posed = plane_problem(Planes::scattered, n, m, random);
        posed.planes[2].normal[1] = bad;
        EXPECT_EQ(solve(posed.as_planes()).status, SolveStatus::invalid_input) << n << ", " << bad;
        posed = plane_problem(Planes::scattered, n, m, random);
        posed.planes[4].offset = bad;
        EXPECT_EQ(solve(posed.as_planes()).status, SolveStatus::invalid_input) << n << ", " << bad;
      }
      Random random(2);
      PlaneProblem posed = plane_problem(Planes::scattered, n, m, random);
      posed.planes[3] = {Vec3::Zero(), 1e-9, 3};
      EXPECT_EQ(solve(posed.as_planes()).status, SolveStatus::infeasible) << n;
      posed.planes[3].offset = 0;
      EXPECT_EQ(solve(posed.as_planes()).status, SolveStatus::optimal) << n;
      posed.planes.resize(static_cast<std::size_t>(posed.problem.rows.rows()) + 1, posed.planes[0]);
      StepProblem too_many = posed.problem.view();
      too_many.planes = posed.planes;
      EXPECT_EQ(solve(too_many).status, SolveStatus::invalid_input) << n;
    }
  }
}

TEST_F(ActiveSetPlanes, TheFirstOfEqualPlanesIsTheActiveOne) {
  for (const std::size_t m : {3U, 12U, 40U, 100U}) {
    std::vector<HalfSpace> planes(m, {Vec3(0, 0, 1), 0.0, 0});
    planes[0].offset = -0.5;
    Problem problem = point_problem(Eigen::Vector3d(0, 0, -1),
                                    StepProblem::RowMatrix::Zero(static_cast<Eigen::Index>(m), 3),
                                    Eigen::VectorXd::Zero(static_cast<Eigen::Index>(m)));
    StepProblem view = problem.view();
    view.planes = planes;
    on_each_simd_target([&] {
      const Answer answer = solve(view);
      ASSERT_EQ(answer.active.size(), 1U);
      EXPECT_EQ(answer.active[0], 1U);
    });
  }
}

}  // namespace
}  // namespace keepout::test
