// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "keepout/step/solver.h"

namespace keepout {

/// The local methods of NLopt for inequality constraints.
enum class NloptMethod : std::uint8_t {
  slsqp,   // sequential least squares (Kraft 1994)
  cobyla,  // linear models, without derivatives (Powell 1994)
  mma      // moving asymptotes, globally convergent (Svanberg 2002)
};

/// The result of keepout's check of a solution from NLopt.
enum class NloptFinding : std::uint8_t {
  refused,      // NLopt was not called: the problem is invalid, ill-posed or too large
  optimal,      // feasible, and within `accuracy` of the best
  not_optimal,  // feasible, but worse
  not_feasible,
  not_finite,
  infeasible  // no solution exists: proved by multipliers of the rows, independently of NLopt
};

/// Returns the name of the enumerator.
std::string_view name(NloptFinding finding) noexcept;

/// The report of NLopt on a problem, and the result of the check.
struct NloptReport {
  std::string_view claim = "not asked";          // the result of NLopt, in its spelling
  NloptFinding finding = NloptFinding::refused;  // the result of the check
};

/// A solver that uses a method of NLopt and checks each solution. The status is `optimal` only if
/// the solution is within `accuracy` of that of ActiveSet. For a problem that ActiveSet rejects or
/// proves infeasible, the status is that of ActiveSet. In all other cases the status is
/// `iteration_limit`.
///
/// An `optimal` solution satisfies each row to 1e-11 of the motion, and the conditions of
/// optimality (KktResidual) to `accuracy`. Its distance from the best u* in task space, |R (u -
/// u*)| with J^T J + damping I = R^T R, is also below `accuracy`. That distance is relative to the
/// larger of |R u*| and |d| / sqrt(n). The solution is NLopt's own point, except for its last
/// digits: the solver moves it onto rows that it violates. Results are reproducible: the work is
/// limited by a number of evaluations, never by time. Allocates while it solves.
class NloptSolver final : public Solver {
 public:
  /// Makes a solver without reserved memory: see reserve.
  explicit NloptSolver(NloptMethod method);
  ~NloptSolver() override;

  /// Returns the accuracy that a method reaches on most well-conditioned problems. The check
  /// rejects answers that are worse. MMA converges too slowly for a better accuracy.
  static constexpr double accuracy(NloptMethod method) noexcept {
    return method == NloptMethod::mma ? 1e-5 : 1e-6;
  }

  /// Returns name and version, such as "NLopt 2.7.1".
  static std::string library();

  void reserve(int variables, int rows) override;
  SolveStatus solve(const StepProblem& problem, Solution& solution) noexcept override;

  /// Returns the report of the last solve, to count the failures of NLopt.
  NloptReport last_report() const noexcept;

 private:
  struct Workspace;
  std::unique_ptr<Workspace> work_;
};

}  // namespace keepout
