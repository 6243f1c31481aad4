// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstdio>
#include <ostream>
#include <string>

#include "compare/comparison_files.h"
#include "compare/comparison_verdict.h"
#include "number_text.h"

namespace keepout::app {
namespace {

template <class... Values>
std::string line(const char* format, Values... values) {
  std::array<char, 256> text;
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

/// An error in two digits, and "0" where there is none at all.
std::string small(double value) { return value == 0.0 ? "0" : line("%.1e", value); }

void print_indices(std::ostream& out, const std::vector<IndexAgreement>& indices) {
  out << "\nIndices in motion constraints, held to brute force (closest points: to exact "
         "arithmetic)\n"
      << line("%-10s %-17s %-10s %-8s %6s %7s %9s %13s %10s %10s %9s\n", "mesh", "index", "rule",
              "form", "poses", "missed", "invented", "closest p. mm", "plane rad", "step mm",
              "differ");
  for (const IndexAgreement& a : indices) {
    out << line("%-10.10s %-17s %-10s %-8s %6zu %7zu %9zu %13s %10s %10s %9zu\n", a.mesh.c_str(),
                a.index.c_str(), a.activation.c_str(), a.searched ? "searches" : "plain", a.poses,
                a.missed, a.invented, small(a.closest_point_error).c_str(),
                small(a.plane_angle).c_str(), small(a.step_difference).c_str(),
                a.steps_that_differ);
  }
}

void print_solvers(std::ostream& out, const std::vector<SolverAgreement>& solvers) {
  out << "\nSolvers on recorded problems, held to active_set and the KKT conditions\n"
      << line("%-13s %-10s %9s %9s %11s %8s %6s %10s %10s %9s %9s\n", "solver", "rule", "problems",
              "optimal", "infeasible", "gave up", "wrong", "step", "KKT", "p50 us", "p99 us");
  for (const SolverAgreement& a : solvers) {
    out << line("%-13s %-10s %9zu %9zu %11zu %8zu %6zu %10s %10s %9s %9s\n", a.solver.c_str(),
                a.activation.c_str(), a.problems, a.optimal, a.infeasible, a.gave_up, a.wrong,
                small(a.step_difference).c_str(), small(a.kkt_residual).c_str(),
                rounded(a.median_us).c_str(), rounded(a.p99_us).c_str());
  }
  out << "  What the library said -> what we found:\n";
  for (const SolverAgreement& a : solvers) {
    for (const auto& [outcome, count] : a.outcomes) {
      out << line("  %-13s %-10s %9zu  %s\n", a.solver.c_str(), a.activation.c_str(), count,
                  outcome.c_str());
    }
  }
}

void print_narrow_phases(std::ostream& out, const std::vector<NarrowPhaseAgreement>& phases) {
  out << "\nNarrow phases, held to our exact kernel; touching: to within " << touch_text
      << ", on either side\n"
      << line("%-16s %-9s %-12s %7s %7s %13s %12s %12s %12s %9s %9s\n", "narrow phase", "tool",
              "relation", "pairs", "failed", "contradicted", "median mm", "worst mm", "unproven mm",
              "p50 us", "p99 us");
  for (const NarrowPhaseAgreement& a : phases) {
    out << line("%-16s %-9s %-12s %7zu %7zu %13zu %12s %12s %12s %9s %9s\n", a.backend.c_str(),
                a.tool.c_str(), a.relation.c_str(), a.pairs, a.failed, a.contradicted,
                small(a.median_error).c_str(), small(a.worst_error).c_str(),
                small(a.worst_unproven).c_str(), rounded(a.median_us).c_str(),
                rounded(a.p99_us).c_str());
  }
}

}  // namespace

void print(std::ostream& out, const Comparison& comparison) {
  if (!comparison.indices.empty()) print_indices(out, comparison.indices);
  if (!comparison.solvers.empty()) print_solvers(out, comparison.solvers);
  if (!comparison.narrow_phases.empty()) print_narrow_phases(out, comparison.narrow_phases);
  out << "\nVerdict\n";
  for (const std::string& paragraph : verdict(comparison)) out << "  " << paragraph << '\n';
}

}  // namespace keepout::app
