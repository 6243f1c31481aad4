// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/solvers/registry.h"

#include "keepout/solvers/active_set.h"
#if KEEPOUT_HAS_NLOPT
#include "keepout/solvers/nlopt_solver.h"
#endif

namespace keepout {
namespace {

template <class T>
std::unique_ptr<Solver> make() {
  return std::make_unique<T>();
}

#if KEEPOUT_HAS_NLOPT
template <NloptMethod method>
constexpr SolverBackend nlopt_backend(std::string_view name, std::string_view description) {
  return {name,
          description,
          []() -> std::unique_ptr<Solver> { return std::make_unique<NloptSolver>(method); },
          Allocation::inside,
          NloptSolver::accuracy(method),
          NloptSolver::library};
}
#endif

constexpr SolverBackend backends[] = {
    {"active_set", "our own dual active-set method (Goldfarb and Idnani 1983)", make<ActiveSet>,
     Allocation::never, 1e-9, nullptr},
#if KEEPOUT_HAS_NLOPT
    nlopt_backend<NloptMethod::slsqp>("nlopt_slsqp", "NLopt: sequential least squares (Kraft)"),
    nlopt_backend<NloptMethod::cobyla>("nlopt_cobyla", "NLopt: linear models (Powell)"),
    nlopt_backend<NloptMethod::mma>("nlopt_mma", "NLopt: moving asymptotes (Svanberg)"),
#endif
};

#if KEEPOUT_HAS_NLOPT
constexpr std::span<const AbsentPart> absent;
#else
constexpr std::string_view needs_nlopt =
    "NLopt (install libnlopt-dev, configure with KEEPOUT_WITH_NLOPT=ON)";
constexpr AbsentPart absent[] = {
    {"nlopt_slsqp", needs_nlopt}, {"nlopt_cobyla", needs_nlopt}, {"nlopt_mma", needs_nlopt}};
#endif

}  // namespace

Registry<SolverBackend> solver_backends() noexcept { return {"solver", backends, absent}; }

std::unique_ptr<Solver> make_solver(std::string_view name) {
  return solver_backends().named(name).make();
}

}  // namespace keepout
