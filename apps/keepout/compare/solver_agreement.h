// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "compare/comparison.h"
#include "keepout/mesh/mesh.h"

namespace keepout::app {

struct SolverComparison {
  std::vector<std::string> rules;
  std::vector<std::string> solvers;
  std::size_t problems = 1000;              // recorded under each rule
  double contradictory = 0.1;               // share of them that is made infeasible
  std::uint64_t seed = 1;                   // same seed, same problems
  std::map<std::string, std::size_t> most;  // problems for a slow solver: evenly from all
};

/// Poses the problems of closed-loop steps to each solver, times it, and judges each answer by the
/// KKT conditions and by active_set. A row for each rule and solver, in this order, up to the one
/// during which it was stopped. Throws Error for an unknown name.
std::vector<SolverAgreement> compare_solvers(const std::shared_ptr<const Mesh>& mesh,
                                             const SolverComparison& comparison,
                                             const Stopped& stopped = never);

}  // namespace keepout::app
