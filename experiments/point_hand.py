# SPDX-License-Identifier: BSD-3-Clause
"""A hand that tries to lead a point through a surface: it sees where both are, and goes for it."""
from __future__ import annotations

import keepout
import numpy as np

from .experiment import Array

#: push: straight in. slide: along the surface, leaning on it. wedge: at corners and edges nearby,
#: and beyond. press: held behind the surface, with a tremor. through: at vertices anywhere.
ROUTES = ("push", "slide", "wedge", "press", "through")


class PointHand:
    """What is asked of a tip, cycle by cycle, along one of ROUTES; at most `longest` mm each.

    The same generator and the same tips give the same motions.
    """

    def __init__(
        self, index: keepout.Index, route: str, longest: float, random: np.random.Generator
    ) -> None:
        self._index = index
        self._mesh = index.mesh
        self._route = route
        self._longest = longest
        self._random = random
        self._period = int(random.integers(10, 80))  # cycles until it thinks anew
        self._attention = 8 if route in ("slide", "wedge") else self._period
        self._cycle = 0
        self._inwards = self._heading = np.zeros(3)
        self._goal: Array | None = None

    def next(self, tip: Array) -> Array:
        """The motion that is asked for, (3,) in mm."""
        if self._cycle % self._attention == 0:
            self._look(tip)
        wish = self._wish(tip)
        self._cycle += 1
        length = float(np.sqrt(wish @ wish))
        return wish * (self._longest / length) if length > self._longest else wish

    def _look(self, tip: Array) -> None:
        triangle, offset = nearest(self._index, tip)
        distance = float(np.linalg.norm(offset))
        self._inwards = offset / distance if distance > 0.0 else self._direction()
        if self._route == "wedge":
            corners = self._mesh.vertices[self._mesh.triangles[triangle]]
            self._goal = (corners[0], (corners[1] + corners[2]) / 2, corners.mean(axis=0))[
                self._random.integers(3)
            ]
        elif self._route == "press":
            self._goal = tip + (distance + 2.0 * self._longest) * self._inwards
        elif self._route == "through":
            self._goal = self._mesh.vertices[self._random.integers(len(self._mesh.vertices))]

    def _wish(self, tip: Array) -> Array:
        turns = self._cycle % self._period == 0
        if self._route == "push":
            return self._longest * self._inwards
        if self._route == "slide":
            if turns:
                self._heading = self._random.uniform(0.3, 2.0) * self._direction()
            return self._longest * (self._inwards + self._heading)
        wish = self._goal - tip
        if self._route == "wedge":
            return self._random.uniform(0.5, 2.0) * wish
        if self._route == "press":
            return wish + self._longest * self._random.uniform(0.0, 2.0) * self._direction()
        return wish

    def _direction(self) -> Array:
        direction = self._random.standard_normal(3)
        return direction / np.linalg.norm(direction)


def nearest(index: keepout.Index, point: Array) -> tuple[int, Array]:
    """The triangle that is nearest to a point, and the way to it, (3,) in mm."""
    distance = float(index.distances(point[None], threads=1)[0])
    hits = index.hits(point, distance * (1.0 + 1e-9) + 1e-9)
    which = int(hits.distances.argmin())
    return int(hits.triangles[which]), hits.offsets[which]


def place_outside(
    index: keepout.Index, clearance: float, height: float, random: np.random.Generator
) -> Array:
    """A place on the side that the normals point to, `height` mm above the surface or less.

    ValueError where none with that clearance [mm] is found: between sheets that are too close.
    """
    mesh = index.mesh
    for attempt in range(400):
        triangle = random.integers(len(mesh.triangles))
        weights = random.dirichlet(np.ones(3))
        up = height * 0.98**attempt
        place = weights @ mesh.vertices[mesh.triangles[triangle]] + up * mesh.normals[triangle]
        if index.distances(place[None], threads=1)[0] > max(clearance, 0.8 * up):
            return place
    raise ValueError("no place outside has the clearance that is to be kept")
