# SPDX-License-Identifier: BSD-3-Clause
"""A shell of bone that a blade cuts: a kerf with walls, and its effect on the tip of the tool.

The kerf is a map of cut depths along and across the path. The blade is a rigid block: `blade` long along the path,
`kerf` wide, its lower end at the tip. Whatever it passes is cut. A spring of the stiffness of robot and tool pulls the
tip to the place that it would have in air. The bone resists: a force F moves a face of area A with the speed
F / (specific resistance times A). The area is that of the bone in front of the blade, beside it or below it. So the
resistance along and across the kerf grows with the depth of engagement, and the walls of a kerf guide the blade.

The resistance of 2.5 N s/mm to a blade that presses on its whole lower end is fitted: hands press with one to two
newtons. Three surgeons pressed an ultrasonic blade with 1.91 N on average ("Ultrasonic tool to cut human bone",
Proc. IMechE H, doi 10.1177/09544119251399865, 2025, abstract). Behind the shell the tool enters soft tissue.
The width of the kerf is ours: Li et al. (2020) do not give it. The model has no friction, chips or vibration.
"""
from __future__ import annotations

from dataclasses import dataclass
from math import exp, sqrt

import numpy as np

from .experiment import Array, dot
from .planned_path import PlannedPath

CELL = 0.05  # of the map across the path [mm]; along it, the cells are the points of the path
HALF_WIDTH = 3.0  # of the map [mm]


@dataclass(frozen=True)
class BoneProperties:
    """The shell, its resistance, and the blade."""

    thickness: float = 2.0  # of the shell, as in the phantoms of Li et al. (2020) [mm]
    resistance: float = 2.5  # force for a feed of 1 mm/s of the lower end of the blade [N s/mm]
    behind: float = 0.05  # resistance behind the shell, as a fraction of it
    blade: float = 1.0  # length of the blade along the path [mm]
    kerf: float = 0.5  # width of the blade across the path [mm]


class Bone:
    """The map `cut`: (points of the path, cells across), the depth that is cut below the outer surface [mm]."""

    def __init__(self, path: PlannedPath, properties: BoneProperties, tip_stiffness: float) -> None:
        self.middle = round(HALF_WIDTH / CELL)  # the number of the cell on the path
        self.cut = np.zeros((len(path.points), 2 * self.middle + 1))
        self._path = path
        self._properties = properties
        self._stiffness = tip_stiffness
        self._half_blade = max(1, round(properties.blade / 2 / path.spacing))
        self._half_kerf = max(1, round(properties.kerf / 2 / CELL))
        self._specific = properties.resistance / (properties.blade * properties.kerf)  # [N s/mm^3]
        self._tip: tuple[float, float, float] | None = None  # along, across and below the path

    def press(self, robot: Array, period: float) -> tuple[Array, float]:
        """Returns the place of a tip that would be at `robot` in air, and its force on the bone [N].

        The tip moves along, then across, then in depth. Each spring relaxes as the bone yields: the exact solution over
        the `period` [s].
        """
        along, across, below = self._path.coordinates(robot)
        before = self._tip
        if before is None or below <= 0.0:
            self._tip = (along, across, below)
            return robot, 0.0
        row, column = self._cell(before[0], before[1])
        depth = before[2]
        beside = self._half_blade + 1 if along > before[0] else -self._half_blade - 1
        ahead = 0.0
        for cell in range(column - self._half_kerf, column + self._half_kerf + 1):
            ahead += self._bone(row + beside, cell, depth)
        tip_along = self._follow(before[0], along, ahead * CELL, period)
        beside = self._half_kerf + 1 if across > before[1] else -self._half_kerf - 1
        wall = 0.0
        for place in range(row - self._half_blade, row + self._half_blade + 1):
            wall += self._bone(place, column + beside, depth)
        tip_across = self._follow(before[1], across, wall * self._path.spacing, period)
        tip_below = self._sink(self._cell(tip_along, tip_across), depth, below, period)
        self._tip = (tip_along, tip_across, tip_below)
        tip = robot + (self._path.place(*self._tip) - self._path.place(along, across, below))
        stretched = tip - robot
        return tip, self._stiffness * sqrt(dot(stretched, stretched))

    def _cell(self, along: float, across: float) -> tuple[int, int]:
        """Returns row and column of the cell at a place, so that the blade stays within the map across the path."""
        column = int((across + HALF_WIDTH) / CELL + 0.5)
        most = self.cut.shape[1] - 2 - self._half_kerf
        return int(along / self._path.spacing + 0.5), min(max(column, self._half_kerf + 1), most)

    def _bone(self, row: int, column: int, depth: float) -> float:
        """Returns how much bone a cell has above a depth [mm]; soft tissue counts less. 0 beyond the ends."""
        if not 0 <= row < len(self.cut):
            return 0.0
        cut, bone = float(self.cut[row, column]), self._properties
        hard = max(0.0, min(depth, bone.thickness) - min(cut, bone.thickness))
        soft = max(0.0, depth - max(cut, bone.thickness))
        return hard + bone.behind * soft

    def _follow(self, tip: float, robot: float, area: float, period: float) -> float:
        """Returns a coordinate of the tip after a period, with bone of this area [mm^2] in the way."""
        if area <= 0.0:
            return robot
        return robot - (robot - tip) * exp(-self._stiffness * period / (self._specific * area))

    def _sink(self, cell: tuple[int, int], depth: float, below: float, period: float) -> float:
        """Returns the depth of the tip after a period, and cuts what is under the blade."""
        row, column = cell
        rows = range(max(0, row - self._half_blade), min(len(self.cut), row + self._half_blade + 1))
        columns = range(column - self._half_kerf, column + self._half_kerf + 1)
        under = self.cut[rows.start : rows.stop, columns.start : columns.stop]
        bearing = int(np.count_nonzero(under <= depth))
        if below <= depth:
            depth = below
        elif bearing == 0:
            depth = min(below, float(under.min()))  # falls to the highest bone under the blade
        else:
            bone = self._properties
            area = bearing * (self._path.spacing * CELL) * (1.0 if depth < bone.thickness else bone.behind)
            depth = self._follow(depth, below, area, period)
        np.maximum(under, depth, out=under)
        return depth
