# SPDX-License-Identifier: BSD-3-Clause
"""The path that is inked on the skull, as the operator sees it."""
from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .experiment import Array


@dataclass(frozen=True)
class PlannedPath:
    """Points at equal spacing along the outer surface; away from the bone is `up`.

    `across` is perpendicular to the plane that the path lies in, the same all along.
    """

    points: Array  # (n, 3) [mm]
    up: Array  # (n, 3), unit
    across: Array  # (3,), unit
    spacing: float  # along the path [mm]

    @property
    def length(self) -> float:
        return self.spacing * (len(self.points) - 1)

    def number(self, along: float) -> int:
        """Of the point nearest to a place along the path [mm]; the ends stand for what is beyond."""
        return min(max(round(along / self.spacing), 0), len(self.points) - 1)

    def at(self, along: float) -> tuple[Array, Array]:
        """The place and `up` there, between points; the ends stand for what is beyond."""
        place = min(max(along / self.spacing, 0.0), len(self.points) - 1.0)
        low = min(int(place), len(self.points) - 2)
        share = place - low
        ends = slice(low, low + 2)
        weights = np.array([1.0 - share, share])
        return weights @ self.points[ends], weights @ self.up[ends]

    @cached_property
    def _heading(self) -> tuple[Array, Array]:
        heading = self.points[-1] - self.points[0]
        return heading, self.points @ heading  # ascends: the path turns by far less than a right angle

    def abreast(self, places: Array) -> NDArray[np.intp]:
        """The numbers of the points abreast of places (m, 3) or (3,), in the direction of the whole path."""
        heading, order = self._heading
        return np.minimum(np.searchsorted(order, places @ heading), len(self.points) - 1)

    def depths(self, places: Array) -> tuple[Array, Array, Array]:
        """Of each of (m, 3) places: along the path, across it and in depth below it, [mm] each."""
        numbers = self.abreast(places)
        offset = places - self.points[numbers]
        return (
            numbers * self.spacing,
            offset @ self.across,
            -np.einsum("ij,ij->i", offset, self.up[numbers]),
        )
