// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "keepout/step/guide.h"

namespace keepout {

/// The forms of a region's text, for help and messages.
inline constexpr std::string_view region_forms =
    "half_space:X,Y,Z:INTO or slab:X,Y,Z:NORMAL:HALF_WIDTH or tube:X,Y,Z:DIRECTION:RADIUS or "
    "ball:X,Y,Z:RADIUS";

/// The forms of the text of an instrument's guide.
inline constexpr std::string_view guide_forms =
    "point:LINK:X,Y,Z:REGION or axis:LINK:AXIS:DIRECTION:ANGLE or "
    "remote_center:LINK:X,Y,Z:LINK:X,Y,Z:CENTER:TOLERANCE";

/// Returns the guide that a text describes, [NAME=]FORM, where FORM is REGION for a tip, such as
/// "corridor=slab:0,0,50:1,0,0:1", or one of `guide_forms` for an instrument: see Region and Guide.
/// Regions are in the frame and unit of the mesh; directions are three numbers of any length. LINK
/// is a link's number, 0 the base; its points are in its frame [length], angles in radians. The
/// name is the form's if none is given. Throws Error, which names what is wrong and the forms.
Guide guide_of_text(std::string_view text);

}  // namespace keepout
