# SPDX-License-Identifier: BSD-3-Clause
"""What a library of collision detection offers: go as far as is free, and stop there.

The motion is shortened to the share after which a ball of the margin's radius touches, and never
turned. With a corridor, the desired motion is first brought into it. A tip that is in contact or
deeper gets what the library says of it: FCL tells such a ball to be in collision from the start, so
that it stays where it is for good; Bullet lets it go wherever it does not come nearer. How either
is asked is in benchmarks/native/sweep.h.
"""
from __future__ import annotations

from functools import lru_cache
from typing import Any

import keepout
import numpy as np

from ..experiment import Array
from .projection import corridor_planes, nearest_motion
from .rule import Task

#: Both need a ball; a margin of 0 is one of this radius. [mm]
LEAST_RADIUS = 0.001


@lru_cache(maxsize=2)
def _model(library: str, mesh: keepout.Mesh, radius: float) -> Any:
    """The mesh as a library has it, which takes long to build and serves all trials on it."""
    import keepout_peers

    return getattr(keepout_peers, library)(mesh.vertices, mesh.triangles, radius)


class StopAtContact:
    """`library`: the function of keepout_peers that makes what tells when there is contact."""

    def __init__(self, task: Task, index: keepout.Index, library: str) -> None:
        self._corridor = task.corridor
        radius = max(task.margin, LEAST_RADIUS)
        self._time_of_impact = _model(library, task.mesh, radius).time_of_impact

    def step(self, tip: Array, desired: Array) -> Array:
        if self._corridor:
            within = nearest_motion(desired, corridor_planes(self._corridor, tip))
            desired = np.zeros(3) if within is None else within
        return self._time_of_impact(tip, desired) * desired
