# SPDX-License-Identifier: BSD-3-Clause
"""A vector-field inequality for the nearest point of the surface.

Marinho, Adorno, Harada, Mitsuishi, "Dynamic active constraints for surgical robots using vector field inequalities",
IEEE T-RO 35, 2019. From this article: the distance d of the tip from an obstacle may fall no faster than -d' <= eta
(d - d_safe). Here the obstacle is the nearest static point of the surface.

Our reading: the nearest point of the mesh is the obstacle, with n = (tip - point) / d, and d_safe is the margin. Over
a period T the inequality is n . dx >= -eta T (d - d_safe). eta is 1 / T. That is the greatest value with which d does
not pass d_safe in one period, and it slows the tip least. Below d_safe the inequality requires a motion outwards, as
in the article, of at most RECOVERY. On the surface n is the normal of the face. A point has no inside, but a mesh has
one: below the surface d is negative and n is reversed, as for the other rules.
"""
from __future__ import annotations

import keepout
import numpy as np

from ..experiment import Array
from .projection import Plane, corridor_planes, is_outside, nearest_motion
from .rule import RECOVERY, Task


class VectorFieldInequality:
    """One plane each cycle."""

    ETA_PERIOD = 1.0  # eta T

    def __init__(self, task: Task, index: keepout.Index) -> None:
        self._task = task
        self._index = index
        self._normals = task.mesh.normals

    def step(self, tip: Array, desired: Array) -> Array:
        margin, gain = self._task.margin, self.ETA_PERIOD
        planes: list[Plane] = corridor_planes(self._task.corridor, tip)
        # If the point is farther away, no desired motion violates the inequality.
        reach = margin + float(np.sqrt(desired @ desired)) / gain
        hits = self._index.hits(tip, reach)
        if len(hits):
            nearest = int(hits.distances.argmin())
            distance = float(hits.distances[nearest])
            if distance > 0.0:
                normal = hits.offsets[nearest] / -distance
                if not is_outside(hits, self._normals):
                    distance, normal = -distance, -normal
            else:
                normal = self._normals[hits.triangles[nearest]]
            planes.append((normal, min(RECOVERY, -gain * (distance - margin))))
        motion = nearest_motion(desired, planes)
        return np.zeros(3) if motion is None else motion
