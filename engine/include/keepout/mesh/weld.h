// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/mesh/mesh.h"

namespace keepout {

/// Merges the vertices whose coordinates are exactly equal (0 and -0 are), and leaves all others
/// apart, however close. Triangles keep their order and winding; none is dropped, degenerate ones
/// neither. Vertices are numbered by their first use; vertices that no triangle uses disappear.
///
/// `threads`: at most; 0 for as many as there are processors. The result is the same.
Surface weld(Surface surface, unsigned threads = 0);

}  // namespace keepout
