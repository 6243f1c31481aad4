# SPDX-License-Identifier: BSD-3-Clause
"""The method that most systems use today: distances on a grid of voxels, and one plane from their gradient.

The distance at each voxel is exact; distances between voxels are interpolated, and anatomy thinner than a voxel is
lost. The rule is that of a single active constraint: the tip moves towards the surface by no more than the field's
distance. Sources: Bowyer, Davies, Rodriguez y Baena, "Active constraints/virtual fixtures: a survey", 2014; as a
linear inequality Marinho et al., "Dynamic active constraints for surgical robots using vector-field inequalities",
2019.
"""
from __future__ import annotations

from functools import lru_cache
from math import floor, inf, sqrt

import keepout
import numpy as np
from numpy.typing import ArrayLike

from ..experiment import Array
from ..sides import lattice_is_solid
from .projection import Plane, corridor_planes, nearest_motion
from .rule import RECOVERY, Task

#: A grid has at most this many voxels: 800 MB in single precision.
MOST_VOXELS = 200_000_000

#: The sampled border around a mesh or a corridor [mm].
AROUND = 5.0

#: The distance up to which a corridor is sampled from its point [mm].
FAR_ALONG = 40.0


class VoxelGrid:
    """Signed distances [mm], negative in the solid, at the corners of cubes of `cell` mm.

    An open mesh has no solid, so its distances have no sign.
    """

    def __init__(
        self, mesh: keepout.Mesh, index: keepout.Index, cell: float, low: ArrayLike, high: ArrayLike
    ) -> None:
        """Samples the box from `low` to `high`, (3,) each, rounded up to whole cells.

        Raises ValueError for a box that is empty or has more than MOST_VOXELS.
        """
        self.cell = float(cell)
        self.low = np.array(low, dtype=np.float64)
        shape = _shape(self.low, np.asarray(high), self.cell)
        if min(shape) < 2 or np.prod(shape) > MOST_VOXELS:
            raise ValueError(f"a grid of {shape} voxels: none, or more than {MOST_VOXELS}")
        self.is_signed = mesh.inspect().watertight
        self.values = np.empty(shape, dtype=np.float32)
        across = np.indices(shape[1:]).reshape(2, -1).T * self.cell + self.low[1:]
        slab = np.empty((len(across), 3))
        slab[:, 1:] = across
        for i in range(shape[0]):
            slab[:, 0] = self.low[0] + i * self.cell
            self.values[i] = index.distances(slab).reshape(shape[1:])
        if self.is_signed:
            solid = lattice_is_solid(mesh, self.low, self.cell, shape)
            np.negative(self.values, out=self.values, where=solid)
        self._flat = self.values.reshape(-1).data  # a memoryview returns plain floats, which is fast
        self._strides = (shape[1] * shape[2], shape[2])

    @property
    def memory(self) -> int:
        """The memory [bytes]."""
        return self.values.nbytes

    def look(self, x: float, y: float, z: float) -> tuple[float, float, float, float]:
        """Returns the interpolated distance and its gradient; infinity outside the grid."""
        cell, (low_x, low_y, low_z), shape = self.cell, self.low.tolist(), self.values.shape
        u, v, w = (x - low_x) / cell, (y - low_y) / cell, (z - low_z) / cell
        i, j, k = floor(u), floor(v), floor(w)
        if not (0 <= i < shape[0] - 1 and 0 <= j < shape[1] - 1 and 0 <= k < shape[2] - 1):
            return inf, 0.0, 0.0, 0.0
        u, v, w = u - i, v - j, w - k
        d, (to_x, to_y) = self._flat, self._strides
        at = i * to_x + j * to_y + k
        # The edges of the cube along z, then its faces, then the cube.
        a, b, c, e = d[at], d[at + to_y], d[at + to_x], d[at + to_x + to_y]
        up_a, up_b = d[at + 1] - a, d[at + to_y + 1] - b
        up_c, up_e = d[at + to_x + 1] - c, d[at + to_x + to_y + 1] - e
        a, b, c, e = a + w * up_a, b + w * up_b, c + w * up_c, e + w * up_e
        near, far = a + v * (b - a), c + v * (e - c)
        up_near, up_far = up_a + v * (up_b - up_a), up_c + v * (up_e - up_c)
        return (
            near + u * (far - near),
            (far - near) / cell,
            ((b - a) + u * ((e - c) - (b - a))) / cell,
            (up_near + u * (up_far - up_near)) / cell,
        )

    def distances(self, points: Array) -> Array:
        """Returns the interpolated distances of (n, 3) points."""
        return np.array([self.look(x, y, z)[0] for x, y, z in points.tolist()])


@lru_cache(maxsize=3)
def shared_grid(
    index: keepout.Index, cell: float,
    low: tuple[float, float, float], high: tuple[float, float, float],
) -> VoxelGrid:
    """Returns the grid of an index, a cell and a box; made once in a process, and shared by trials."""
    return VoxelGrid(index.mesh, index, cell, low, high)


class SignedDistanceField:
    """The rule n . motion >= -(distance - margin), n along the gradient: a rule.Rule.

    Outside the grid every motion is free. Without a `grid` argument, the grid covers the whole mesh. With a corridor,
    it covers only the part of it within FAR_ALONG of its point. Both have a border of AROUND.
    """

    def __init__(
        self, task: Task, index: keepout.Index, cell: float, grid: VoxelGrid | None = None
    ) -> None:
        self._task = task
        self.grid = grid or _grid_for(task, index, cell)

    def step(self, tip: Array, desired: Array) -> Array:
        """Returns zero motion if the plane and the corridor contradict each other."""
        x, y, z = tip.tolist()
        distance, n_x, n_y, n_z = self.grid.look(x, y, z)
        room = max(distance - self._task.margin, -RECOVERY)
        steep = sqrt(n_x * n_x + n_y * n_y + n_z * n_z)
        planes: list[Plane] = corridor_planes(self._task.corridor, tip)
        if distance < inf and steep > 0.0:  # a flat field gives no direction
            if not planes:
                # One plane: add the missing distance along its normal.
                d_x, d_y, d_z = desired.tolist()
                missing = -room - (n_x * d_x + n_y * d_y + n_z * d_z) / steep
                if missing <= 0.0:
                    return desired
                t = missing / steep
                return np.array([d_x + t * n_x, d_y + t * n_y, d_z + t * n_z])
            planes.append((np.array([n_x, n_y, n_z]) / steep, -room))
        motion = nearest_motion(desired, planes)
        return np.zeros(3) if motion is None else motion


def _shape(
    low: Array, high: Array, cell: float
) -> tuple[int, int, int]:
    cells = np.ceil((high - low) / cell - 1e-9).astype(int) + 1
    return int(cells[0]), int(cells[1]), int(cells[2])


def _grid_for(task: Task, index: keepout.Index, cell: float) -> VoxelGrid:
    low, high = task.mesh.bounds[0] - AROUND, task.mesh.bounds[1] + AROUND
    if task.corridor is not None:
        point, normal = np.array(task.corridor.point), np.abs(task.corridor.normal)
        along = FAR_ALONG * np.sqrt(np.maximum(0.0, 1.0 - normal**2))
        half_size = along + (task.corridor.half_width + AROUND) * normal
        low, high = np.maximum(low, point - half_size), np.minimum(high, point + half_size)
    return shared_grid(index, cell, tuple(low.tolist()), tuple(high.tolist()))
