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

/// Returns the guide that a text [NAME=]FORM describes: see Region and Guide. For a tip, FORM is
/// one of `region_forms`, as in "corridor=slab:0,0,50:1,0,0:1"; for an instrument, one of
/// `guide_forms`. Regions are in the frame and unit of the mesh; directions are three numbers of
/// any length. LINK is the number of a link, 0 for the base; points are in the frame of their link
/// [length], angles in radians. The default name is the name of the form. Throws Error, which names
/// the fault and the forms.
Guide guide_of_text(std::string_view text);

}  // namespace keepout
