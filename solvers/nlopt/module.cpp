// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/solvers/nlopt_solver.h"
#include "keepout/solvers/registry.h"

namespace keepout {
namespace {

template <NloptMethod method>
constexpr SolverBackend backend(std::string_view name, std::string_view description) {
  return {name,
          description,
          []() -> std::unique_ptr<Solver> { return std::make_unique<NloptSolver>(method); },
          Allocation::inside,
          NloptSolver::accuracy(method),
          NloptSolver::library};
}

constexpr SolverBackend backends[] = {
    backend<NloptMethod::slsqp>("nlopt_slsqp", "NLopt: sequential least squares (Kraft)"),
    backend<NloptMethod::cobyla>("nlopt_cobyla", "NLopt: linear models (Powell)"),
    backend<NloptMethod::mma>("nlopt_mma", "NLopt: moving asymptotes (Svanberg)"),
};

}  // namespace
}  // namespace keepout

const std::span<const keepout::SolverBackend> keepout_solvers = keepout::backends;
