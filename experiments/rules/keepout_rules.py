# SPDX-License-Identifier: BSD-3-Clause
"""keepout's own rules: all faces, that of Li et al. (2020), and the certified one."""
from __future__ import annotations

from functools import lru_cache
from typing import Any

import keepout
import numpy as np

from ..experiment import Array
from .rule import Task


@lru_cache(maxsize=2)
def _anatomy(mesh: keepout.Mesh) -> Any:
    """Returns a mesh and its index as the C++ loop of trials needs them."""
    import keepout_trial

    return keepout_trial.Anatomy(mesh.vertices, mesh.triangles)


class KeepoutRule:
    """A `keepout.MotionConstraint` with an activation rule and, if there is one, the corridor as a guide."""

    def __init__(self, task: Task, index: keepout.Index, activation: str) -> None:
        self._task, self._activation = task, activation
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

    def native(self) -> Any:
        """Returns the same rule for the C++ loop of trials: it makes the same motions without Python."""
        task = self._task
        return _anatomy(task.mesh).rule(self._activation, task.radius, task.margin, task.corridor)
