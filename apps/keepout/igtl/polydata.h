// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string_view>

#include "igtl/message.h"
#include "keepout/mesh/mesh.h"

namespace keepout::app::igtl {

/// Returns the triangles of the content of a POLYDATA message: its polygons, which must be
/// triangles, and its triangle strips. Ignores vertices, lines and attributes. The coordinates are
/// not checked. Throws Error, which says what is wrong: for sizes that contradict each other, a
/// point that does not exist, a polygon that is not a triangle, or no triangle. Allocates at most
/// three times the size of the content.
Surface read_polydata(Bytes content);

/// Appends a POLYDATA message of triangles, without common points. [length]
void write_polydata(ByteList& out, std::string_view device, double stamp,
                    std::span<const Triangle> triangles);

}  // namespace keepout::app::igtl
