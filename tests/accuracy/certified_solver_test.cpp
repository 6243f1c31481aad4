// SPDX-License-Identifier: BSD-3-Clause
// A certified motion maintains its clearance, whatever a solver returns.

#include "accuracy/certified_loop.h"
#include "guards.h"

namespace keepout::test::certified_solver {
namespace {

constexpr double radius = 1.0, margin = 0.25;

/// A solver with relative noise in its solutions.
class Sloppy final : public Solver {
 public:
  explicit Sloppy(double noise) : noise_(noise), random_(1) {}

  void reserve(int variables, int rows) override {
    exact_.reserve(variables, rows);
    u_.resize(static_cast<std::size_t>(variables));
  }

  SolveStatus solve(const StepProblem& problem, Solution& solution) noexcept override {
    const SolveStatus status = exact_.solve(problem, solution);
    if (status != SolveStatus::optimal) return status;
    double size = 0.0;
    for (const double u : solution.u) size = std::max(size, std::abs(u));
    for (std::size_t i = 0; i < solution.u.size(); ++i) {
      u_[i] = solution.u[i] + noise_ * size * random_.uniform(-1.0, 1.0);
    }
    solution.u = {u_.data(), solution.u.size()};
    return status;
  }

 private:
  ActiveSet exact_;
  double noise_;
  Random random_;
  std::vector<double> u_;
};

/// A solver with arbitrary solutions and statuses.
class Liar final : public Solver {
 public:
  Liar() : random_(2) {}

  void reserve(int variables, int) override { u_.resize(static_cast<std::size_t>(variables)); }

  SolveStatus solve(const StepProblem& problem, Solution& solution) noexcept override {
    const auto n = static_cast<std::size_t>(problem.jacobian.cols());
    const double size = std::pow(10.0, random_.uniform(-12.0, 1.0));
    for (std::size_t i = 0; i < n; ++i) u_[i] = size * random_.uniform(-1.0, 1.0);
    switch (random_.below(8)) {
      case 0:  // the desired motion, even if it violates planes
        for (std::size_t i = 0; i < std::min<std::size_t>(n, 3); ++i) u_[i] = problem.desired[i];
        break;
      case 1:
        u_[0] = nan;
        break;
      case 2:
        u_[n - 1] = 1e300;
        break;
      case 3:
        return SolveStatus::infeasible;
      default:
        break;
    }
    solution.u = {u_.data(), random_.below(16) == 0 ? n - 1 : n};
    return SolveStatus::optimal;
  }

 private:
  Random random_;
  std::vector<double> u_;
};

MotionConstraint guard_with(const std::shared_ptr<const Mesh>& mesh, std::unique_ptr<Solver> solver,
                            double damping = 0.0) {
  return guard_of<PdTree>(mesh, {.radius = radius, .margin = margin, .damping = damping},
                          std::move(solver), std::make_unique<CertifiedRule>(), {.planes = 200});
}

class CertifiedSolver : public testing::TestWithParam<Shape> {
 protected:
  CertifiedSolver()
      : loop(GetParam().make(),
             {.options = {.radius = radius, .margin = margin}, .capacity = {.planes = 200}}) {}

  /// Runs cycles that press into the surface. Returns the worst loss, in tolerances.
  template <class Judge>
  double run(MotionConstraint& guard, bool joints, int cycles, const Judge& judge) {
    Random random(7);
    double worst = 0.0;
    for (const Vec3& start : surface_points(loop.mesh(), 20, 1.3 * margin, random)) {
      if (loop.distance(start) < margin) continue;
      const Vec3 press = loop.towards_surface(start);
      TipJacobian::Matrix jacobian(3, 4);
      for (int c = 0; c < 4; ++c) jacobian.col(c) = random.uniform(0.5, 2.0) * random.direction();
      Vec3 tip = start;
      for (int cycle = 0; cycle < cycles; ++cycle) {
        const Vec3 desired = random.uniform(0.1, 0.5) * (press + random.direction());
        Motion motion{.tip = tip, .desired = desired};
        if (joints) motion.jacobian = jacobian;
        const Step step = guard.step(motion);
        if (!step.ok()) {
          EXPECT_EQ(step.motion, Vec3::Zero());
        }
        worst = std::max(worst, loop.loss(tip, tip + step.motion));
        judge(motion, step);
        tip += step.motion;
      }
    }
    return worst;
  }

  Loop loop;
};

TEST_P(CertifiedSolver, ASloppyOneIsSafeAndOfUse) {
  auto guard = guard_with(loop.shared_mesh(), std::make_unique<Sloppy>(1e-8));
  auto exact = guard_with(loop.shared_mesh(), std::make_unique<ActiveSet>());
  std::size_t cycles = 0, worse = 0, not_ok = 0, truncated = 0;
  const double worst = run(guard, false, 30, [&](const Motion& motion, const Step& step) {
    ++cycles;
    if (!step.ok()) ++not_ok;
    if (step.status == Status::truncated) ++truncated;
    const Step best = exact.step(motion);
    const double cost = (step.motion - motion.desired).norm();
    if (cost > (best.motion - motion.desired).norm() + 1e-3 * motion.desired.norm()) ++worse;
  });
  EXPECT_LE(worst, 3.0);
  EXPECT_EQ(not_ok, 0u) << "of " << cycles;
  EXPECT_LE(truncated, cycles / 100);
  EXPECT_LE(worse, cycles / 50) << "of " << cycles;
}

TEST_P(CertifiedSolver, ASloppyOneIsSafeWithJoints) {
  auto guard = guard_with(loop.shared_mesh(), std::make_unique<Sloppy>(1e-8), 1e-6);
  EXPECT_LE(run(guard, true, 30, [](const Motion&, const Step&) {}), 3.0);
}

TEST_P(CertifiedSolver, NoLieMakesAMotionUnsafe) {
  for (const bool joints : {false, true}) {
    auto guard = guard_with(loop.shared_mesh(), std::make_unique<Liar>());
    std::size_t moved = 0;
    const double worst = run(guard, joints, 40, [&](const Motion&, const Step& step) {
      if (step.ok()) ++moved;
      ASSERT_TRUE(step.motion.allFinite());
      ASSERT_LE(step.motion.norm(), radius * (1.0 + 1e-8));
    });
    EXPECT_LE(worst, 3.0);
    EXPECT_GT(moved, 20u);
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, CertifiedSolver, testing::ValuesIn(shapes()), by_name);

}  // namespace
}  // namespace keepout::test::certified_solver
