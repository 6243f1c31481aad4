// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keepout/solvers/registry.h"

#include "keepout/registry.h"
#include "keepout/solvers/active_set.h"

namespace keepout {
namespace {

template <class T>
std::unique_ptr<Solver> make() {
  return std::make_unique<T>();
}

constexpr SolverBackend backends[] = {
    {"active_set", "our own dual active-set method (Goldfarb and Idnani 1983)", make<ActiveSet>,
     Allocation::never, 1e-9, nullptr},
};

}  // namespace

std::span<const SolverBackend> solver_backends() noexcept { return backends; }

std::span<const AbsentPart> absent_solver_backends() noexcept { return {}; }

std::unique_ptr<Solver> make_solver(std::string_view name) {
  return entry_named(name, backends, "solver", absent_solver_backends()).make();
}

}  // namespace keepout
