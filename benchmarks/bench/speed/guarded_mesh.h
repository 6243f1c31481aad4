// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "keepout/fixtures/motions.h"
#include "keepout/fixtures/random.h"
#include "keepout/step/motion_constraint.h"

namespace keepout::app {

/// A mesh to measure on, and an index over it.
struct IndexedMesh {
  std::shared_ptr<const Mesh> mesh;
  std::shared_ptr<const SpatialIndex> index;
};

/// With our index, wide_bvh.
IndexedMesh with_index(std::shared_ptr<const Mesh> mesh);

/// The same index as one that only answers queries: no rule traversals it by itself.
IndexedMesh queried(const IndexedMesh& on);

/// The same surface with coordinates as an STL file holds them.
Surface in_single_precision(Surface surface);

/// The bunny, 150 mm large, with so many triangles (or up to three fewer), as an STL file holds it.
/// Throws Error where the fixture has not been prepared.
std::shared_ptr<const Mesh> bunny_of(std::size_t triangles);

/// The file of a bunny that is large: made once, and kept beside the fixtures. Throws Error.
std::filesystem::path large_bunny(std::size_t triangles);

/// What users run: the certified rule with our solver. [mm]
MotionConstraint certified(const IndexedMesh& on, double margin);

/// The paper's rule with a solver. [mm]
MotionConstraint paper(const IndexedMesh& on, double radius, const std::string& solver);

/// Asks both for a sample of the motions. Empty if all answers were the same, bit for bit; else a
/// remark on how many were not. With an accuracy, for solvers of which one is not exact: status
/// apart, motions may differ by so much of the length of the one asked for.
std::string disagreement(MotionConstraint& one, MotionConstraint& other,
                         std::span<const Motion> motions, double accuracy = 0.0);

// Commands of operators. Each throws Error where the mesh has hardly any room for such motions.

/// Returns motions of an operator who presses a tool against the surface and drags it along
/// (pressing_increment) in strokes of 50 cycles, while the certified rule keeps it `kind.clearance`
/// off: the tip goes where the step leads it, as in a control loop. Only limited cycles count.
std::vector<Motion> pressed_motions(const IndexedMesh& on, std::size_t count,
                                    const MotionKind& kind, Random random);

/// How far from the surface a tool is led. [length]
struct FreeSpace {
  double nearest = 2.0;
  double farthest = 20.0;
};

/// Returns motions of an operator who leads a tool through free space, on a smooth path, cycle
/// after cycle: nothing limits it. The lengths of the increments are those of `kind`.
std::vector<Motion> free_motions(const IndexedMesh& on, std::size_t count, const FreeSpace& space,
                                 const MotionKind& kind, Random random);

/// All over the surface, as a planner asks, and only where it holds the motion back under the
/// certified rule: elsewhere there is hardly anything to time.
std::vector<Motion> held_back_motions(const IndexedMesh& on, std::size_t count,
                                      const MotionKind& kind, Random random);

/// Back and forth around the origin: in a sphere around it all triangles are equally far.
std::vector<Motion> central_motions(std::size_t count, const MotionKind& kind, Random random);

}  // namespace keepout::app
