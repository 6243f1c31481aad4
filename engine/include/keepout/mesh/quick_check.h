// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "keepout/mesh/mesh.h"

namespace keepout {

/// Whether a mesh has edges of two kinds that a guard's user should know of. What doctor.h counts.
struct EdgeFaults {
  bool boundary = false;      // some edge has one triangle: the surface is open
  bool inconsistent = false;  // some edge has two triangles, wound against each other
};

/// As examine() would find, up to a chance of 2^-64; for a surface with few such edges in a
/// thirtieth of the time, some 5 ms for a million triangles and a processor. On `threads` threads
/// at once; 0: as many as there are processors.
EdgeFaults find_edge_faults(const Mesh& mesh, unsigned threads = 0);

/// A unit that the numbers of a file may be in.
struct UnitGuess {
  std::string_view unit;  // "m", "cm", "in", "um"
  double millimetres;     // that one is
};

/// The units other than millimetres in which something of that largest extent would be of the size
/// that organs have, 20 to 600 mm. A size that is usual in millimetres has none: from 30 on.
std::vector<UnitGuess> other_units(double extent);

/// What a mesh should not guard anything without: a sentence each, for people, on a size that is
/// none of anatomy in millimetres, on an open surface, and on an inconsistent winding. Empty when
/// there is nothing to say. As quick as find_edge_faults.
std::vector<std::string> quick_check(const Mesh& mesh, unsigned threads = 0);

}  // namespace keepout
