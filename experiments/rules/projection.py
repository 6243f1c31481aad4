# SPDX-License-Identifier: BSD-3-Clause
"""The nearest motion that planes allow, and the side of a tip, for rules that are not keepout's own."""
from __future__ import annotations

import keepout
import numpy as np
from scipy.optimize import nnls

from ..experiment import Array
from .rule import Corridor

#: A half-space of motions d: normal . d >= offset.
Plane = tuple[Array, float]


def nearest_motion(desired: Array, planes: list[Plane]) -> Array | None:
    """Returns the d nearest to `desired` with normal . d >= offset for each plane, or None if there is no such d.

    Least distance programming (Lawson and Hanson, "Solving Least Squares Problems", 1974, chapter 23).
    """
    short = [(n, o - n @ desired) for n, o in planes if n @ desired < o]
    if not short:
        return desired
    normals = np.array([n for n, _ in planes])
    missing = np.array([o for _, o in planes]) - normals @ desired
    scale = max(1e-12, float(np.abs(missing).max()))
    target = np.array([0.0, 0.0, 0.0, 1.0])
    system = np.vstack([normals.T, missing / scale])
    weights, residual = nnls(system, target)
    if residual < 1e-9:
        return None
    rest = system @ weights - target
    return desired - rest[:3] / rest[3] * scale


def corridor_planes(corridor: Corridor | None, tip: Array) -> list[Plane]:
    """Returns the planes that keep a tip within the corridor; a tip outside moves no farther out."""
    if corridor is None:
        return []
    normal = np.array(corridor.normal)
    beside = float(normal @ (tip - np.array(corridor.point)))
    low = min(0.0, beside + corridor.half_width)  # outside already: it may stay, but not move farther out
    high = min(0.0, corridor.half_width - beside)
    return [
        (normal, -(beside + corridor.half_width) if low == 0.0 else 0.0),
        (-normal, -(corridor.half_width - beside) if high == 0.0 else 0.0),
    ]


def is_outside(hits: keepout.Hits, normals: Array) -> bool:
    """Decides by the sum of the normals of the triangles that have the nearest point; True without hits.

    This is the pseudonormal of Baerentzen and Aanaes (2005) without the weights by angle. It is as correct if the
    faces around the point turn by no more than a right angle. A tip on the surface is outside.
    """
    if not len(hits):
        return True
    distances = hits.distances
    nearest = distances <= distances.min() * (1.0 + 1e-9)
    away = normals[hits.triangles[nearest]].sum(axis=0)
    return float(hits.offsets[nearest][0] @ away) <= 0.0
