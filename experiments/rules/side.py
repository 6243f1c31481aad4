# SPDX-License-Identifier: BSD-3-Clause
"""On which side of a surface a tip is, for rules that look at its nearest points."""
from __future__ import annotations

import keepout
import numpy as np

from ..experiment import Array


def is_outside(hits: keepout.Hits, normals: Array) -> bool:
    """Told by the sum of the normals of the triangles that have the nearest point; True without hits.

    That is the pseudonormal of Baerentzen and Aanaes (2005) but for the weights by angle, and as right
    where the faces around the point do not turn by more than a right angle. A tip on the surface is outside.
    """
    if not len(hits):
        return True
    distances = hits.distances
    nearest = distances <= distances.min() * (1.0 + 1e-9)
    away = normals[hits.triangles[nearest]].sum(axis=0)
    return float(hits.offsets[nearest][0] @ away) <= 0.0
