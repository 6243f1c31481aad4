// SPDX-License-Identifier: BSD-3-Clause
// Runs the contracts of an index and of a solver on the tables of the plugin.
#include "keepout/testing/index_contract.h"
#include "keepout/testing/solver_contract.h"

using keepout::IndexContract;
INSTANTIATE_TEST_SUITE_P(Mine, IndexContract, testing::ValuesIn(keepout_indices), keepout::by_name);

// Hildreth's method is slow, and proves no problem infeasible. So its tests are fewer, and allow it
// to give up.
using keepout::test::SolverContract;
INSTANTIATE_TEST_SUITE_P(Mine, SolverContract,
                         testing::Values(keepout::test::SolverUnderTest{
                             keepout_solvers[0],
                             {.stride = 211,
                              .most_rows = 200,
                              .gives_up = {0.2, 0.9, 0.95},
                              .proves_infeasible = false}}),
                         keepout::by_name);
