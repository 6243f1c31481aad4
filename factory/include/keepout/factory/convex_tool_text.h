// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "keepout/geometry/convex_tool.h"

namespace keepout {

/// The forms of a tool's text, for help and messages.
inline constexpr std::string_view convex_tool_forms =
    "sphere:R or capsule:X,Y,Z:X,Y,Z:R or box:X,Y,Z:X,Y,Z or blade:LENGTH:WIDTH:THICKNESS or "
    "hull:X,Y,Z:...[:R] or hull:FILE";

/// A convex tool from a text of one of these forms. The tip is the origin, the axes are the mesh's,
/// lengths in its unit. A box lies between two opposite corners. A blade is a box that rises LENGTH
/// along z from the tip, WIDTH across in x and THICKNESS in y, the tip amid its lower end. A hull
/// is that of points, or of the vertices of a mesh file. Throws Error, which names what is wrong
/// and the forms; as well where ConvexTool does, and where a file cannot be read.
ConvexTool tool_of_text(std::string_view text);

}  // namespace keepout
