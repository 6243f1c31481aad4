// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "keepout/fixtures/random.h"
#include "keepout/mesh/mesh.h"
#include "keepout/solvers/recording_solver.h"

namespace keepout::app {

/// The problems that closed-loop steps in contact pose: a hand presses the tip against the mesh and
/// drags it along, motions of 0.05 to 0.2 mm, a sphere of 5 mm, a margin of 0.2 mm. In every third
/// stroke seven joints move the tip, damped. Throws Error for an unknown rule, and where such
/// motions pose too few problems, as on a mesh in another unit.
std::vector<RecordedProblem> record_problems(const std::shared_ptr<const Mesh>& mesh,
                                             const std::string& rule, std::size_t count,
                                             std::uint64_t seed);

/// Adds a row that contradicts some of the others: with weights of order 1 they add up to
/// 0 u >= a margin, 1e-6 to 1 of the motion asked for.
void contradict(RecordedProblem& problem, Random& random);

}  // namespace keepout::app
