// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "keepout/geometry/convex_tool.h"

namespace keepout {

/// The forms of a tool's text, a line each, for help and messages.
extern const std::string_view convex_tool_forms;

/// A convex tool from one line of text, such as "capsule:0,0,0:0,0,12:1.5". The tip is the origin,
/// the axes are the mesh's, and all numbers are in its unit:
///
///     sphere:R                         a ball around the tip
///     capsule:X,Y,Z:X,Y,Z:R            all within R of a segment
///     box:X,Y,Z:X,Y,Z                  along the axes, between two opposite corners
///     blade:LENGTH:WIDTH:THICKNESS     a box that rises LENGTH along z from the tip, WIDTH across
///                                      in x and THICKNESS in y, the tip amid its lower end
///     hull:X,Y,Z:...[:R]               all within R of the hull of the points
///     hull:FILE                        the hull of the vertices of a mesh file
///
/// Throws Error, which names what is wrong and the form that was meant; as well where ConvexTool
/// does, and where the file is none or cannot be read. Reads a file, and allocates.
ConvexTool tool_of_text(std::string_view text);

}  // namespace keepout
