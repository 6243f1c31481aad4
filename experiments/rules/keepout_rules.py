# SPDX-License-Identifier: BSD-3-Clause
"""keepout's own rules: all faces, that of Li et al. (2020), and the certified one."""
from __future__ import annotations

import keepout
import numpy as np

from ..experiment import Array
from .rule import Task


class KeepoutRule:
    """A `keepout.MotionConstraint` with an activation rule and, if there is one, the corridor as a guide."""

    def __init__(self, task: Task, index: keepout.Index, activation: str) -> None:
        self._guard = keepout.MotionConstraint(
            task.mesh, index=index, activation=activation, radius=task.radius, margin=task.margin
        )
        if task.corridor:
            slab = keepout.Region.slab(
                task.corridor.point, task.corridor.normal, task.corridor.half_width
            )
            self._guard.set_guides([keepout.Guide.point("corridor", slab)])

    def step(self, tip: Array, desired: Array) -> Array:
        """Returns zero if keepout rejects the motion; the status of the step has the reason."""
        motion: Array = self._guard.step(tip, desired).motion
        return motion
