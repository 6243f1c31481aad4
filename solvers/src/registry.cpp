// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/solvers/registry.h"

#include "keepout/module.h"
#include "keepout/solvers/active_set.h"

namespace keepout {
namespace {

constexpr SolverBackend ours[] = {
    {"active_set", "our own dual active-set method (Goldfarb and Idnani 1983)",
     []() -> std::unique_ptr<Solver> { return std::make_unique<ActiveSet>(); }, Allocation::never,
     1e-9, nullptr}};

constexpr std::string_view needs_nlopt =
    "NLopt (install keepout-modules; in the sources, install libnlopt-dev and set "
    "KEEPOUT_WITH_NLOPT=ON)";
constexpr PeerPart peers[] = {{"nlopt_slsqp", needs_nlopt, "nlopt"},
                              {"nlopt_cobyla", needs_nlopt, "nlopt"},
                              {"nlopt_mma", needs_nlopt, "nlopt"}};

PartTable<SolverBackend>& table() {
  static PartTable<SolverBackend> table("solver", ours, peers, "keepout_solvers");
  return table;
}

}  // namespace

Registry<SolverBackend> solver_backends() { return table().all(); }

std::size_t add_solver_backends(const std::string& plugin) { return table().add(plugin); }

std::vector<std::string> solver_names() { return table().names(); }

std::unique_ptr<Solver> make_solver(std::string_view name) { return table().named(name).make(); }

}  // namespace keepout
