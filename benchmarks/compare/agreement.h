// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "compare/comparison.h"
#include "keepout/fixtures/random.h"
#include "keepout/mesh/mesh.h"
#include "keepout/solvers/recording_solver.h"

namespace keepout::app {

// How well parts agree that can take each other's place. Each function shows on stderr how far it
// has come, and gives the rows that were finished when it was stopped.

/// What the indices are compared on.
struct IndexComparison {
  std::string mesh_name;
  std::shared_ptr<const Mesh> mesh;
  std::vector<std::string> indices, activations;
  std::size_t poses = 100;
  std::uint64_t seed = 1;
};

/// Builds the motion constraint that make_motion_constraint gives, with each index and each rule,
/// and holds what the index finds around the tip, the planes and the steps to brute force, and
/// closest points to exact arithmetic. Half of the poses are in contact, the others off the
/// surface, on vertices and on edges. `stopped` is asked before each pose, of brute force and of
/// each index, under each rule.
std::vector<IndexAgreement> compare_indices(const IndexComparison& comparison,
                                            const Stopped& stopped = never);

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

/// What the solvers are compared on.
struct SolverComparison {
  std::vector<std::string> rules;
  std::vector<std::string> solvers;
  std::size_t problems = 1000;              // recorded under each rule; a tenth made infeasible
  std::uint64_t seed = 1;                   // same seed, same problems
  std::map<std::string, std::size_t> most;  // problems for a slow solver: evenly from all
};

/// Poses the problems of closed-loop steps to each solver, times it, and judges each answer by the
/// KKT conditions and by active_set. A row for each rule and solver, in this order. Throws Error
/// for an unknown name.
std::vector<SolverAgreement> compare_solvers(const std::shared_ptr<const Mesh>& mesh,
                                             const SolverComparison& comparison,
                                             const Stopped& stopped = never);

/// Holds each narrow phase of this build to the exact kernel: instrument-like tools of 2 mm to 5
/// mm, turned at random, at triangles of the mesh picked at random; as many pairs apart (up to 5
/// mm), touching (within 1e-6 mm) and overlapping (by 0.001 mm or more). All get the same pairs.
std::vector<NarrowPhaseAgreement> compare_narrow_phases(const Mesh& mesh, std::size_t pairs,
                                                        std::uint64_t seed,
                                                        const Stopped& stopped = never);

}  // namespace keepout::app
