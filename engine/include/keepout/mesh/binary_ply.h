// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>

#include "keepout/mesh/load_mesh.h"
#include "keepout/mesh/mesh.h"

namespace keepout {

/// Writes a binary little-endian PLY file to a binary stream, whose state the caller must check.
/// Coordinates are exact. They are floats if every coordinate is exactly a float, else doubles. A
/// comment states `space` if it is known, as 3D Slicer writes it. load_mesh() reads the file back.
/// Throws Error if there are more vertices than the format can number, 2^31.
void write_binary_ply(std::ostream& out, const Surface& surface, AnatomicalSpace space);

}  // namespace keepout
