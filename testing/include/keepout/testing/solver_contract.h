// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// The tests that every solver must pass, for the rows of a solver registry or of a plugin:
//
//     using keepout::test::SolverContract;
//     INSTANTIATE_TEST_SUITE_P(Mine, SolverContract,
//     testing::Values(keepout::test::SolverUnderTest{row}),
//                              keepout::by_name);

#include "keepout/testing/solver_infeasibility.h"
#include "keepout/testing/solver_input.h"
#include "keepout/testing/solver_optimality.h"
