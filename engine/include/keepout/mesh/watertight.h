// SPDX-FileCopyrightText: 2026 the keepout authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "keepout/mesh/mesh.h"

namespace keepout {

/// Whether each edge has two triangles, wound alike: such a mesh has a free side everywhere, which
/// its winding tells. Segments, which name a vertex twice, are passed over. Time: some .1 s for a
/// million triangles.
bool is_watertight(const Mesh& mesh);

}  // namespace keepout
