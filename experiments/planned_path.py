# SPDX-License-Identifier: BSD-3-Clause
"""The path that is inked on the skull, which the operator sees."""
from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .experiment import Array


@dataclass(frozen=True)
class PlannedPath:
    """Points at equal spacing along the outer surface; `up` points away from the bone.

    `across` is perpendicular to the plane of the path, and constant.
    """

    points: Array  # (n, 3) [mm]
    up: Array  # (n, 3), unit
    across: Array  # (3,), unit
    spacing: float  # along the path [mm]

    @property
    def length(self) -> float:
        return self.spacing * (len(self.points) - 1)

    def number(self, along: float) -> int:
        """Returns the number of the point nearest to a place along the path [mm], limited to the ends."""
        return min(max(round(along / self.spacing), 0), len(self.points) - 1)

    @cached_property
    def heading(self) -> Array:
        """The vector from the first point to the last, (3,)."""
        heading: Array = self.points[-1] - self.points[0]
        return heading

    @cached_property
    def order(self) -> Array:
        """The scalar product of each point with the heading, (n,). It ascends, because the path turns by much less
        than a right angle."""
        order: Array = self.points @ self.heading
        return order

    def depths(self, places: Array) -> tuple[Array, Array, Array]:
        """Returns for each of (m, 3) places: along the path, across it, and in depth below it, each in mm.

        Each place has the point of the path beside it, in the direction of the whole path.
        """
        numbers = np.minimum(np.searchsorted(self.order, places @ self.heading), len(self.points) - 1)
        offset = places - self.points[numbers]
        return (
            numbers * self.spacing,
            offset @ self.across,
            -np.einsum("ij,ij->i", offset, self.up[numbers]),
        )
