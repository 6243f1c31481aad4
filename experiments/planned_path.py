# SPDX-License-Identifier: BSD-3-Clause
"""The path that is inked on the skull, which the operator sees."""
from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .experiment import Array, dot


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

    def at(self, along: float) -> tuple[Array, Array]:
        """Returns the interpolated position at a place along the path, and `up` there, limited to the ends."""
        place = min(max(along / self.spacing, 0.0), len(self.points) - 1.0)
        low = min(int(place), len(self.points) - 2)
        share = place - low
        return (
            (1.0 - share) * self.points[low] + share * self.points[low + 1],
            (1.0 - share) * self.up[low] + share * self.up[low + 1],
        )

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

    def coordinates(self, place: Array) -> tuple[float, float, float]:
        """Returns where a place (3,) is: along the path, across it, and below it [mm]. Limited to the ends along."""
        ahead = dot(place, self.heading)
        low = min(max(int(np.searchsorted(self.order, ahead)) - 1, 0), len(self.order) - 2)
        share = (ahead - self.order[low]) / (self.order[low + 1] - self.order[low])
        along = min(max((low + share) * self.spacing, 0.0), self.length)
        point, up = self.at(along)
        offset = place - point
        return along, dot(offset, self.across), -dot(offset, up)

    def place(self, along: float, across: float, below: float) -> Array:
        """Returns the place (3,) with these coordinates."""
        point, up = self.at(along)
        place: Array = point + across * self.across - below * up
        return place

    def abreast(self, places: Array) -> NDArray[np.intp]:
        """Returns the numbers of the points beside places (m, 3) or (3,), in the direction of the whole path."""
        return np.minimum(np.searchsorted(self.order, places @ self.heading), len(self.points) - 1)

    def depths(self, places: Array) -> tuple[Array, Array, Array]:
        """Returns for each of (m, 3) places: along the path, across it, and in depth below it, each in mm."""
        numbers = self.abreast(places)
        offset = places - self.points[numbers]
        return (
            numbers * self.spacing,
            offset @ self.across,
            -np.einsum("ij,ij->i", offset, self.up[numbers]),
        )
