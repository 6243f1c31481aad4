// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "compare/comparison.h"
#include "keepout/mesh/mesh.h"
#include "progress.h"

namespace keepout::app {

/// How many rows compare_narrow_phases() has: what its progress advances to.
std::size_t narrow_phase_rows() noexcept;

/// Holds each narrow phase of this build to the exact kernel: instrument-like tools of 2 mm to 5
/// mm, turned at random, at triangles of the mesh picked at random; as many pairs apart (up to 5
/// mm), touching (within 1e-6 mm) and overlapping (by 0.001 mm or more). All get the same pairs.
/// Up to the row before which it was stopped.
std::vector<NarrowPhaseAgreement> compare_narrow_phases(const Mesh& mesh, std::size_t pairs,
                                                        std::uint64_t seed, Progress& progress,
                                                        const Stopped& stopped = never);

}  // namespace keepout::app
