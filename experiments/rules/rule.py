# SPDX-License-Identifier: BSD-3-Clause
"""What a rule is: it takes where the tip is and how it is to move, and says how it may."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import keepout
import numpy as np

from ..experiment import Array


#: A tip nearer than the margin is led off it by so much in a cycle at the most, by each rule [mm].
RECOVERY = 0.05


@dataclass(frozen=True)
class Corridor:
    """The tip stays within `half_width` [mm] of the plane through `point` with the unit `normal`."""

    point: tuple[float, float, float]
    normal: tuple[float, float, float]
    half_width: float


@dataclass(frozen=True)
class Task:
    """What a rule is to do: keep the tip, a ball of no size, `margin` [mm] off a mesh.

    `radius` [mm] is that of the motion sphere: no desired motion is longer. A corridor is kept
    besides, if there is one.
    """

    mesh: keepout.Mesh
    margin: float = 0.2
    radius: float = 5.0
    corridor: Corridor | None = None


class Rule(Protocol):
    """One for each trial: a rule may remember what happened. Add one of your own here and in modes.py."""

    def step(self, tip: Array, desired: Array) -> Array:
        """The allowed motion, (3,) in mm, for a tip at `tip` that is to move by `desired`."""
        ...
