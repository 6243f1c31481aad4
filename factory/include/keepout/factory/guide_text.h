// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

#include "keepout/step/guide.h"
#include "keepout/step/tip_guides.h"

namespace keepout {

/// The forms of a region's text, for help and messages.
inline constexpr std::string_view region_forms =
    "half_space:X,Y,Z:INTO or slab:X,Y,Z:NORMAL:HALF_WIDTH or tube:X,Y,Z:DIRECTION:RADIUS or "
    "ball:X,Y,Z:RADIUS";

/// The same of what guides an instrument.
inline constexpr std::string_view guide_forms =
    "point:LINK:X,Y,Z:REGION or axis:LINK:AXIS:DIRECTION:ANGLE or "
    "remote_center:LINK:X,Y,Z:LINK:X,Y,Z:CENTER:TOLERANCE";

/// A guide of a tip from a text, [NAME=]REGION, such as "corridor=slab:0,0,50:1,0,0:1": see Region.
/// Directions are three numbers of any length; all is in the frame and the unit of the mesh. A
/// guide without a name is called as its form. Throws Error, which names what is wrong and the
/// forms.
TipGuide tip_guide_of_text(std::string_view text);

/// A guide of an instrument, [NAME=]FORM: see Guide. LINK is a link's number, 0 the base; its
/// points are in its frame [length], angles in radians. Throws as that of a tip.
Guide guide_of_text(std::string_view text);

}  // namespace keepout
