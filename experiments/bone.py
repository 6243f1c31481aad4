# SPDX-License-Identifier: BSD-3-Clause
"""A shell of bone that a piezoelectric blade cuts, and its effect on the tip of the tool.

The tip presses on the bottom of the kerf with the force that bends robot and tool. The kerf deepens as fast as that
force allows: feed = force / resistance. Three surgeons who cut bone with an ultrasonic blade pressed with 1.91 N on
average (Proc. IMechE H, doi 10.1177/09544119251399865, 2025). The resistance is fitted so that the simulated hands
press with one to two newtons. Behind the shell the tool enters soft tissue. The model has no forces along and across
the kerf, because the blade vibrates along it.
"""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .experiment import Array
from .planned_path import PlannedPath


@dataclass(frozen=True)
class BoneProperties:
    thickness: float = 2.0  # of the shell, as in the phantoms of Li et al. (2020) [mm]
    resistance: float = 2.5  # force for a feed of 1 mm/s [N s/mm]
    behind: float = 0.05  # resistance behind the shell, as a fraction of it
    blade: float = 1.0  # length of the path that the blade covers [mm]


class Bone:
    """The kerf: the depth that is cut at each point of the path [mm]."""

    def __init__(self, path: PlannedPath, properties: BoneProperties, tip_stiffness: float) -> None:
        self.cut = np.zeros(len(path.points))
        self._path = path
        self._properties = properties
        self._stiffness = tip_stiffness
        self._half_blade = max(1, round(properties.blade / 2 / path.spacing))

    def press(self, tip: Array, period: float) -> tuple[Array, float]:
        """Returns the position of the tip, which would be `tip` in air, and its force on the bone [N]."""
        path, bone = self._path, self._properties
        at = int(path.abreast(tip))
        depth = -float((tip - path.points[at]) @ path.up[at])
        under = self.cut[max(0, at - self._half_blade) : at + self._half_blade + 1]
        bottom = float(under.mean())  # the blade rests on all the bone below it
        if depth <= bottom:
            return tip, 0.0
        hard = bone.resistance * (1.0 if bottom < bone.thickness else bone.behind)
        # The spring relaxes as the kerf deepens: the exact solution over the period.
        left = (depth - bottom) * np.exp(-self._stiffness / hard * period)
        np.maximum(under, np.minimum(under + (depth - left - bottom), depth - left), out=under)
        return tip + left * path.up[at], self._stiffness * left
