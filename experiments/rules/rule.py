# SPDX-License-Identifier: BSD-3-Clause
"""The interface of a rule: from the tip and its desired motion, it returns the allowed motion."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import keepout

from ..experiment import Array


@dataclass(frozen=True)
class Corridor:
    """The tip stays within `half_width` [mm] of the plane through `point` with the unit `normal`."""

    point: tuple[float, float, float]
    normal: tuple[float, float, float]
    half_width: float


@dataclass(frozen=True)
class Task:
    """The task of a rule: keep the tip, a point, `margin` [mm] away from a mesh.

    `radius` [mm] is that of the motion sphere: no desired motion is longer. The tip must also stay in the corridor,
    if there is one.
    """

    mesh: keepout.Mesh
    margin: float = 0.2
    radius: float = 5.0
    corridor: Corridor | None = None


class Rule(Protocol):
    """One for each trial: a rule may remember earlier cycles. The rules of C++ are in native.py.

    E1 and E5 use one rule for all loops on a shape with a step length.
    """

    def step(self, tip: Array, desired: Array) -> Array:
        """Returns the allowed motion, (3,) in mm, for a tip at `tip` and a desired motion `desired`."""
        ...
