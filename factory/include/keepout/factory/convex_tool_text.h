// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "keepout/geometry/convex_tool.h"

namespace keepout {

/// The forms of a tool's text, for help and messages.
inline constexpr std::string_view convex_tool_forms =
    "sphere:R or capsule:X,Y,Z:X,Y,Z:R or box:X,Y,Z:X,Y,Z or blade:LENGTH:WIDTH:THICKNESS or "
    "hull:X,Y,Z:...[:R] or hull:FILE";

/// Returns the convex tool that a text describes in one of these forms. The origin is the tip; axes
/// and unit are those of the mesh. A box has two opposite corners. A blade is a box from the tip to
/// LENGTH along z, with WIDTH in x and THICKNESS in y, centered on the tip. A hull is the convex
/// hull of points, or of the vertices of a mesh file. Throws Error, which names the fault and the
/// forms, for another text, a tool that ConvexTool refuses, and a file that cannot be read.
ConvexTool tool_of_text(std::string_view text);

}  // namespace keepout
