// SPDX-FileCopyrightText: 2026 the keepout authors
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

/// How NLopt said that it had ended.
enum class NloptClaim : std::uint8_t {
  not_asked,  // the problem was refused before
  success,
  stopval_reached,
  ftol_reached,
  xtol_reached,
  maxeval_reached,
  maxtime_reached,
  failure,
  invalid_args,
  out_of_memory,
  roundoff_limited,
  forced_stop,
  unknown
};

/// What our check of its answer found.
enum class NloptFinding : std::uint8_t {
  refused,      // no answer was looked at: invalid, ill-posed or too large
  optimal,      // feasible, and proven to be within the accuracy of the best
  not_optimal,  // feasible, but no such proof: worse than the accuracy, or rounding hides it
  not_feasible,
  not_finite,
  infeasible  // no answer exists: proven by weights on the rows, whatever NLopt said
};

/// As NLopt spells it.
std::string_view name(NloptClaim claim) noexcept;

/// The name as it stands in the enumeration.
std::string_view name(NloptFinding finding) noexcept;

/// What NLopt said of a problem, and what was found.
struct NloptReport {
  NloptClaim claim = NloptClaim::not_asked;      // NLopt's word
  NloptFinding finding = NloptFinding::refused;  // that of our check
};

/// A method of NLopt, of which nothing is believed: an answer counts as optimal only when it
/// satisfies the rows and multipliers of our own prove how near it is to the best, and a problem as
/// infeasible only with weights that prove it. Anything else is `iteration_limit`.
///
/// Refuses what ActiveSet refuses. "optimal" satisfies each row to 1e-11 of the motion at most, and
/// is nearer than `accuracy` to the best in task space, |R (u - u*)| with J^T J + damping I =
/// R^T R, relative to the larger of |R u| and |d| / sqrt(n). It may differ from NLopt's own point
/// by as much, where last digits were put right. The same problem always gives the same answer: the
/// work is limited by a number of evaluations and never by time. It allocates while it solves.
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
