# SPDX-License-Identifier: BSD-3-Clause
"""A simulated hand that tries to push a point through a surface; it sees both."""
from __future__ import annotations

import keepout
import numpy as np

from .experiment import Array

#: push: straight in. slide: along the surface, leaning on it. wedge: at corners and edges nearby, and beyond. press:
#: towards a place behind the surface, with a tremor. through: at random vertices.
ROUTES = ("push", "slide", "wedge", "press", "through")


class PointHand:
    """The desired motion of a tip in each cycle, along one of ROUTES, at most `longest` mm long.

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
        self._period = int(random.integers(10, 80))  # cycles until it decides again
        self._attention = 8 if route in ("slide", "wedge") else self._period
        self._cycle = 0
        self._inwards = self._heading = np.zeros(3)
        self._goal: Array | None = None

    def next(self, tip: Array) -> Array:
        """Returns the desired motion, (3,) in mm."""
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
    """Returns the triangle nearest to a point, and the vector to it, (3,) in mm."""
    distance = float(index.distances(point[None], threads=1)[0])
    hits = index.hits(point, distance * (1.0 + 1e-9) + 1e-9)
    which = int(hits.distances.argmin())
    return int(hits.triangles[which]), hits.offsets[which]


def place_outside(
    index: keepout.Index, clearance: float, height: float, random: np.random.Generator
) -> Array:
    """Returns a place on the side that the normals point to, at most `height` mm above the surface.

    Raises ValueError if it finds no place with that clearance [mm], as between sheets that are too close.
    """
    mesh = index.mesh
    for attempt in range(400):
        triangle = random.integers(len(mesh.triangles))
        weights = random.dirichlet(np.ones(3))
        up = height * 0.98**attempt
        place = weights @ mesh.vertices[mesh.triangles[triangle]] + up * mesh.normals[triangle]
        if index.distances(place[None], threads=1)[0] > max(clearance, 0.8 * up):
            return place
    raise ValueError("no place outside has the required clearance")
