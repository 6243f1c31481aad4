# SPDX-License-Identifier: BSD-3-Clause
"""A shell of bone that a blade cuts: a kerf with walls, and its effect on the tip of the tool.

The kerf is a map of cut depths along and across the path. The blade is a rigid block: `blade` long along the path,
`kerf` wide, its lower end at the tip. It cuts all bone that it passes. A spring of the stiffness of robot and tool
pulls the tip to the place that it would have in air. The bone resists: a force F moves a face of area A with the speed
F / (specific resistance times A). The area is that of the bone in front of the blade, beside it or below it. So the
resistance along and across the kerf grows with the depth of engagement, and the walls of a kerf guide the blade.

The resistance of 2.5 N s/mm to a blade that presses on its whole lower end is fitted: hands press with one to two
newtons. Three surgeons pressed an ultrasonic blade with 1.91 N on average ("Ultrasonic tool to cut human bone",
Proc. IMechE H, doi 10.1177/09544119251399865, 2025, abstract). Behind the shell the tool enters soft tissue.
The width of the kerf is ours: Li et al. (2020) do not give it. The model has no friction, chips or vibration.
"""
from __future__ import annotations

from dataclasses import dataclass

CELL = 0.05  # of the map across the path, as in bone.cpp [mm]; along it, the cells are the points of the path


@dataclass(frozen=True)
class BoneProperties:
    """The shell, its resistance, and the blade."""

    thickness: float = 2.0  # of the shell, as in the phantoms of Li et al. (2020) [mm]
    resistance: float = 2.5  # force for a feed of 1 mm/s of the lower end of the blade [N s/mm]
    behind: float = 0.05  # resistance behind the shell, as a fraction of it
    blade: float = 1.0  # length of the blade along the path [mm]
    kerf: float = 0.5  # width of the blade across the path [mm]
