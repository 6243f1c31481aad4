// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bench/speed/indexed_mesh.h"
#include "bench/speed/speed_run.h"

namespace keepout::app {

// The families of rows. Each verifies what it times beforehand: a wrong answer is not timed, and
// the row says so.

/// Triangles within a ball at random places near the surface, ids only: every index, and its
/// candidates by one scalar exact test where it is not exact by itself.
void measure_sphere_queries(SpeedRun& run, const IndexedMesh& on);

/// A whole step with the paper's rule, in contact: ours, and what the usual libraries would make.
void measure_paper_steps(SpeedRun& run, const IndexedMesh& on);

/// A whole certified step, in contact and in free space, at two margins and lengths of motion.
void measure_certified_steps(SpeedRun& run, const IndexedMesh& on);

/// The same on meshes of 16 and 100 million triangles.
void measure_large_meshes(SpeedRun& run);

/// The inside of a sphere: at the centre all triangles are equally far.
void measure_concave_sphere(SpeedRun& run);

/// Tips all over the surface, as a planner asks.
void measure_unrelated_states(SpeedRun& run, const IndexedMesh& on);

/// Steps after each of which the caches are emptied.
void measure_cold_caches(SpeedRun& run, const IndexedMesh& on);

/// From a file to the first step.
void measure_first_step(SpeedRun& run);

/// What the index takes to be built, to be refitted, and to hold.
void measure_index_costs(SpeedRun& run, const IndexedMesh& on);

/// Page faults, allocations and locks of steps after warm-up, and a histogram of their times.
void measure_steadiness(SpeedRun& run, const IndexedMesh& on);

}  // namespace keepout::app
