// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "keepout/step/solver.h"

namespace keepout {

/// Which of NLopt's local methods for inequality constraints.
enum class NloptMethod : std::uint8_t {
  slsqp,   // sequential least squares (Kraft 1994)
  cobyla,  // linear models, without derivatives (Powell 1994)
  mma      // moving asymptotes, globally convergent (Svanberg 2002)
};

/// What our check of its answer found.
enum class NloptFinding : std::uint8_t {
  refused,      // NLopt was not asked: the problem is invalid, ill-posed or too large
  optimal,      // feasible, and within the accuracy of the best
  not_optimal,  // feasible, and worse
  not_feasible,
  not_finite,
  infeasible  // no answer exists: proven by weights on the rows, whatever NLopt said
};

/// The name as it stands in the enumeration.
std::string_view name(NloptFinding finding) noexcept;

/// What NLopt said of a problem, and what was found.
struct NloptReport {
  std::string_view claim = "not asked";          // how it ended, as NLopt spells it
  NloptFinding finding = NloptFinding::refused;  // that of our check
};

/// A method of NLopt, of which nothing is believed: an answer counts as optimal only when it is as
/// near as `accuracy` to the one that ActiveSet has found. What ActiveSet refuses is refused, and
/// what it has proven to be infeasible is. Anything else is `iteration_limit`.
///
/// "optimal" satisfies each row to 1e-11 of the motion at most, and the conditions of optimality
/// (KktResidual) to `accuracy`; it is nearer than that to the best in task space, |R (u - u*)| with
/// J^T J + damping I = R^T R, relative to the larger of |R u*| and |d| / sqrt(n). It is NLopt's own
/// point, but for the last digits that put it onto the rows which it violates. The same problem
/// always gives the same answer: the work is limited by a number of evaluations and never by time.
/// It allocates while it solves.
class NloptSolver final : public Solver {
 public:
  /// Without room yet: see reserve.
  explicit NloptSolver(NloptMethod method);
  ~NloptSolver() override;

  /// What each reaches on most well-conditioned problems; the check sees to it that no answer is
  /// worse. MMA converges too slowly for more.
  static constexpr double accuracy(NloptMethod method) noexcept {
    return method == NloptMethod::mma ? 1e-5 : 1e-6;
  }

  /// "NLopt 2.7.1"
  static std::string library();

  void reserve(int variables, int rows) override;
  SolveStatus solve(const StepProblem& problem, Solution& solution) noexcept override;

  /// Of the last solve: so that the failures of NLopt can be counted.
  NloptReport last_report() const noexcept;

 private:
  struct Workspace;
  std::unique_ptr<Workspace> work_;
};

}  // namespace keepout
