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

/// Returns the mesh with keepout's index, wide_bvh.
IndexedMesh with_index(std::shared_ptr<const Mesh> mesh);

/// Returns the same index with queries only: no rule can use its traversal.
IndexedMesh queried(const IndexedMesh& on);

/// Returns the surface with coordinates in the precision of an STL file.
Surface in_single_precision(Surface surface);

/// Returns the bunny, 150 mm large, with `triangles` triangles (or up to three fewer), in the
/// precision of an STL file. Throws Error if the sample mesh is missing.
std::shared_ptr<const Mesh> bunny_of(std::size_t triangles);

/// Returns the file of a large bunny, which is made once and kept beside the sample meshes. Throws
/// Error if it cannot be made.
std::filesystem::path large_bunny(std::size_t triangles);

/// Returns the constraint that users run: the certified rule with keepout's solver. [mm]
MotionConstraint certified(const IndexedMesh& on, double margin);

/// Returns a constraint with the paper's rule and a solver. [mm]
MotionConstraint paper(const IndexedMesh& on, double radius, const std::string& solver);

/// Compares the steps of both for a sample of the motions. Returns empty if all are bitwise
/// identical, otherwise a remark with the number that differ. With an accuracy above 0, for solvers
/// that are not exact, motions may differ by that fraction of the desired length, and statuses may
/// differ.
std::string disagreement(MotionConstraint& one, MotionConstraint& other,
                         std::span<const Motion> motions, double accuracy = 0.0);

// Motions of operators. Each function throws Error if the mesh has hardly any place for such
// motions.

/// Returns motions of an operator who presses a tool against the surface and drags it along
/// (pressing_increment), in strokes of 50 cycles. The certified rule keeps the tool at
/// `kind.clearance`, and the tip follows the steps as in a control loop. Only limited cycles count.
std::vector<Motion> pressed_motions(const IndexedMesh& on, std::size_t count,
                                    const MotionKind& kind, Random random);

/// The distances from the surface between which a tool moves. [length]
struct FreeSpace {
  double nearest = 2.0;
  double farthest = 20.0;
};

/// Returns motions of an operator who moves a tool through free space on a smooth path. The mesh
/// limits none of them. The lengths of the increments are those of `kind`.
std::vector<Motion> free_motions(const IndexedMesh& on, std::size_t count, const FreeSpace& space,
                                 const MotionKind& kind, Random random);

/// Returns motions all over the surface, as for a planner. Keeps only those that the mesh limits
/// under the certified rule: other steps take almost no time.
std::vector<Motion> held_back_motions(const IndexedMesh& on, std::size_t count,
                                      const MotionKind& kind, Random random);

/// Returns motions back and forth near the origin: in a sphere around it, all triangles are equally
/// far.
std::vector<Motion> central_motions(std::size_t count, const MotionKind& kind, Random random);

}  // namespace keepout::app
