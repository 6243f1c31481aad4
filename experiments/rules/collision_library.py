# SPDX-License-Identifier: BSD-3-Clause
"""A rule from a library of collision detection: move until contact, and stop there.

The motion is shortened to the fraction at which a ball of the margin's radius makes contact, and never turned. With a
corridor, the desired motion is first projected into it. A tip in contact or deeper gets the library's answer. FCL
reports a collision from the start, so the tip never moves again. Bullet allows motions that do not approach.
benchmarks/native/sweep.h describes the queries.
"""
from __future__ import annotations

from functools import lru_cache
from typing import Any

import keepout
import numpy as np

from ..experiment import Array
from .projection import corridor_planes, nearest_motion
from .rule import Task

#: Both libraries need a ball; for a margin of 0 it has this radius. [mm]
LEAST_RADIUS = 0.001


@lru_cache(maxsize=2)
def _model(library: str, mesh: keepout.Mesh, radius: float) -> Any:
    """Returns the library's model of the mesh, which takes long to build and serves all trials on it."""
    import keepout_peers

    return getattr(keepout_peers, library)(mesh.vertices, mesh.triangles, radius)


class StopAtContact:
    """`library`: the name of the function of keepout_peers that makes the library's Sweep."""

    def __init__(self, task: Task, index: keepout.Index, library: str) -> None:
        self._corridor = task.corridor
        radius = max(task.margin, LEAST_RADIUS)
        self._time_of_impact = _model(library, task.mesh, radius).time_of_impact

    def step(self, tip: Array, desired: Array) -> Array:
        if self._corridor:
            within = nearest_motion(desired, corridor_planes(self._corridor, tip))
            desired = np.zeros(3) if within is None else within
        return self._time_of_impact(tip, desired) * desired
