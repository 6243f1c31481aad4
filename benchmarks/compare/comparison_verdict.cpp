// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <set>

#include "compare/comparison.h"
#include "shared/names.h"
#include "shared/number_text.h"

namespace keepout::app {
namespace {

std::size_t sum(const auto& rows, auto count) {
  std::size_t result = 0;
  for (const auto& row : rows) result += row.*count;
  return result;
}

/// What the rows with any call themselves, each name once, in the order of the rows.
std::vector<std::string> names_of(const auto& rows, auto name, auto any) {
  std::vector<std::string> result;
  for (const auto& row : rows) {
    if (row.*any && std::ranges::find(result, row.*name) == result.end()) {
      result.push_back(row.*name);
    }
  }
  return result;
}

/// The same as one text; empty where there are none.
std::string guilty(const auto& rows, auto name, auto count) {
  return listed(names_of(rows, name, count));
}

/// Beside the first solver, which all are held to.
std::string why_fewer(const std::vector<SolverAgreement>& rows, const SolverAgreement& of) {
  double least = 0.0, most = 0.0;
  for (const SolverAgreement& row : rows) {
    if (row.solver != of.solver) continue;
    for (const SolverAgreement& reference : rows) {
      if (reference.solver != rows.front().solver || reference.activation != row.activation ||
          reference.median_us == 0.0) {
        continue;
      }
      const double times = row.median_us / reference.median_us;
      least = least == 0.0 ? times : std::min(least, times);
      most = std::max(most, times);
    }
  }
  return " " + of.solver + " got " + grouped(of.problems) + " of " + grouped(of.posed) +
         " under each rule, evenly spread, as it takes " + ratio_text(least) +
         (least == most ? "" : " to " + ratio_text(most)) + " times as long as " +
         rows.front().solver + ".";
}

/// Equal steps are no finding where they could not be otherwise: on where that is so.
std::string by_construction(const std::vector<IndexAgreement>& rows) {
  std::string text =
      "By construction the exact kernel decides, whichever index proposes: a plain rule can only "
      "come to another step by a triangle that the index missed or gave twice.";
  const auto indices = names_of(rows, &IndexAgreement::index, &IndexAgreement::searched);
  const auto rules = names_of(rows, &IndexAgreement::activation, &IndexAgreement::searched);
  if (indices.empty()) return text;
  return text + " Not so where the rule searches the index by itself, which is what " +
         listed(rules) + (rules.size() == 1 ? " does" : " do") + " on " + listed(indices) +
         ": these steps were found in another way than brute force's.";
}

}  // namespace

std::string index_verdict(const std::vector<IndexAgreement>& rows) {
  const std::size_t poses = sum(rows, &IndexAgreement::poses);
  const std::size_t wrong =
      sum(rows, &IndexAgreement::missed) + sum(rows, &IndexAgreement::invented);
  const std::size_t differ = sum(rows, &IndexAgreement::steps_that_differ);
  std::string text = "Of " + grouped(poses) + " queries, held to brute force one by one, ";
  if (wrong == 0) {
    text += "no index missed a triangle or invented one";
  } else {
    const std::string missing = guilty(rows, &IndexAgreement::index, &IndexAgreement::missed);
    const std::string inventing = guilty(rows, &IndexAgreement::index, &IndexAgreement::invented);
    if (!missing.empty()) {
      text += missing + " missed " + counted(sum(rows, &IndexAgreement::missed), "triangle");
    }
    if (!inventing.empty()) {
      text += (missing.empty() ? "" : ", and ") + inventing + " invented " +
              counted(sum(rows, &IndexAgreement::invented), "triangle");
    }
  }
  std::set<std::string> indices;
  for (const IndexAgreement& row : rows) indices.insert(row.index);
  text += differ == 0 ? (indices.size() == 1
                             ? "; " + *indices.begin() + " gives"
                             : "; all " + std::to_string(indices.size()) + " indices give") +
                            " brute force's steps, bit for bit."
                      : "; " + grouped(differ) + (differ == 1 ? " step differs" : " steps differ") +
                            " from brute force's in some bit.";
  return text + " " + by_construction(rows);
}

std::string solver_verdict(const std::vector<SolverAgreement>& rows) {
  const std::string wrong = guilty(rows, &SolverAgreement::solver, &SolverAgreement::wrong);
  const std::string quit = guilty(rows, &SolverAgreement::solver, &SolverAgreement::gave_up);
  std::string shorter;
  for (const SolverAgreement& row : rows) {
    const bool is_first = &row == &*std::ranges::find(rows, row.solver, &SolverAgreement::solver);
    if (is_first && row.problems < row.posed) shorter += why_fewer(rows, row);
  }
  std::string text =
      shorter.empty() ? "Each solver got the same recorded problems, and every answer was checked; "
                      : "All solvers got problems of one recorded set, slow ones a share of it, "
                        "and every answer was checked; ";
  text += wrong.empty()
              ? "none was wrong"
              : wrong + " gave " + counted(sum(rows, &SolverAgreement::wrong), "answer") +
                    " that " + (sum(rows, &SolverAgreement::wrong) == 1 ? "is" : "are") + " wrong";
  text += quit.empty() ? ", and none gave up."
                       : ", and " + quit + " gave up " +
                             how_often(sum(rows, &SolverAgreement::gave_up)) + ".";
  return text + shorter;
}

std::string narrow_phase_verdict(const std::vector<NarrowPhaseAgreement>& rows) {
  const auto backend = &NarrowPhaseAgreement::backend;
  const auto contradicted = &NarrowPhaseAgreement::contradicted;
  // Where the two touch, a library may take one for the other within its tolerance.
  std::vector<NarrowPhaseAgreement> clear, touching;
  for (const NarrowPhaseAgreement& row : rows) {
    (row.relation == "touching" ? touching : clear).push_back(row);
  }
  const std::string contrary = guilty(clear, backend, contradicted);
  const std::string confused = guilty(touching, backend, contradicted);
  const std::string failing = guilty(rows, backend, &NarrowPhaseAgreement::failed);
  std::string text = "Distance between a tool and a triangle, held to the exact kernel: ";
  text += contrary.empty() ? "none called apart what overlaps, or the reverse"
                           : contrary + " took apart for overlapping, or the reverse, " +
                                 how_often(sum(clear, contradicted));
  if (!confused.empty()) {
    text += contrary.empty() ? "; " + confused + " did so " : ", and ";
    if (!contrary.empty() && confused != contrary) text += confused + " ";
    text += how_often(sum(touching, contradicted)) + (contrary.empty() ? "" : " more") +
            " where the two touch to within " + touch_text;
  }
  return text + (failing.empty() ? ", and all gave an answer."
                                 : ", and " + failing + " gave no answer " +
                                       how_often(sum(rows, &NarrowPhaseAgreement::failed)) + ".");
}

bool agree(const Comparison& comparison) {
  return std::ranges::all_of(comparison.indices,
                             [](const IndexAgreement& a) {
                               return a.missed == 0 && a.invented == 0 && a.plane_angle == 0.0 &&
                                      a.steps_that_differ == 0;
                             }) &&
         std::ranges::all_of(comparison.solvers,
                             [](const SolverAgreement& a) { return a.wrong == 0; });
}

std::vector<std::string> verdict(const Comparison& comparison) {
  std::vector<std::string> paragraphs;
  const auto add = [&](const char* what, const auto& rows, auto in_words) {
    if (!rows.empty()) paragraphs.push_back(what + in_words(rows));
  };
  add("Indices: ", comparison.indices, index_verdict);
  add("Solvers: ", comparison.solvers, solver_verdict);
  add("Narrow phases, which are not all ours: ", comparison.narrow_phases, narrow_phase_verdict);
  if (!comparison.complete) {
    const std::size_t rows =
        comparison.indices.size() + comparison.solvers.size() + comparison.narrow_phases.size();
    paragraphs.push_back("Interrupted: " + counted(rows, "row") + (rows == 1 ? " was" : " were") +
                         " finished, and nothing is said of the others.");
  }
  if (!agree(comparison)) {
    paragraphs.emplace_back("Parts that must not differ do: please report it.");
  } else if (!comparison.indices.empty() || !comparison.solvers.empty()) {
    paragraphs.emplace_back(comparison.complete ? "All parts agree that must."
                                                : "So far all parts agree that must.");
  }
  return paragraphs;
}

}  // namespace keepout::app
