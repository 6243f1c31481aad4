# SPDX-License-Identifier: BSD-3-Clause
"""The anatomy: named meshes, the path on the CT skull, and the phantom that is cut.

The skull of Li et al. (2020) is of a child, and not public. Ours is the adult CT skull of the sample meshes. The path
is 30 mm long, on the outside of the skull, in the sagittal plane at the vertex. Theirs lies on the sagittal suture.
"""
from __future__ import annotations

import os
import subprocess
from functools import lru_cache
from pathlib import Path

import keepout
import numpy as np
from scipy.ndimage import gaussian_filter

from .experiment import Array
from .planned_path import PlannedPath

#: The sagittal plane of the skull, and the start of the path in it [mm]; z is up.
SAGITTAL_X = 125.0
PATH_BEGINS = 90.0
PATH_LENGTH = 30.0
SHELL = 2.0  # thickness of the phantoms of Li et al. [mm]


def mesh_file(name: str) -> Path:
    """Returns the file of a real mesh; prepares the mesh if necessary. Raises an error if it cannot."""
    root = Path(__file__).resolve().parent.parent
    cache = Path(os.environ.get("KEEPOUT_CACHE", root / ".cache"))
    file = cache / "fixtures" / f"{name}.stl"
    if not file.exists():
        prepare = os.environ.get("KEEPOUT_PREPARE", str(root / "fixtures" / "prepare"))
        subprocess.run([prepare, name], check=True)
    return file


@lru_cache(maxsize=2)
def real_index(name: str) -> keepout.Index:
    """Returns the index of a real mesh, with the mesh as `.mesh`. Built once in a process."""
    return keepout.Index(keepout.load_mesh(mesh_file(name)))


def outer_surface(index: keepout.Index, x: Array, y: Array) -> Array:
    """Returns the z of the first bone that a ray from above hits at each place, in the shape of x and y [mm].

    Each ray advances by the distance of the nearest triangle until that is 0 (sphere tracing, Hart 1996). Raises
    ValueError if a ray hits no bone.
    """
    top = float(index.mesh.bounds[1, 2]) + 1.0
    points = np.stack([x, y, np.full_like(x, top)], axis=-1).reshape(-1, 3)
    for _ in range(1000):
        gap = index.distances(points, threads=1)
        points[:, 2] -= gap
        if np.all(gap < 1e-6):
            z: Array = points[:, 2].reshape(x.shape)
            return z
        if points[:, 2].min() < top - 50.0:
            break
    raise ValueError("a ray from above meets no bone within 50 mm of the vertex")


def _path(y: Array, z: Array, spacing: float) -> PlannedPath:
    """Returns the path through (SAGITTAL_X, y, z), with equal spacing and PATH_LENGTH long."""
    ways = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(y), np.diff(z)))])
    at = np.arange(0.0, PATH_LENGTH + spacing / 2, spacing)
    y, z = np.interp(at, ways, y), np.interp(at, ways, z)
    slope_y, slope_z = np.gradient(y, spacing), np.gradient(z, spacing)
    flat = np.zeros_like(y)
    up = np.stack([flat, -slope_z, slope_y], axis=1)
    return PlannedPath(
        points=np.stack([flat + SAGITTAL_X, y, z], axis=1),
        up=up / np.linalg.norm(up, axis=1, keepdims=True),
        across=np.array([1.0, 0.0, 0.0]),
        spacing=spacing,
    )


@lru_cache(maxsize=2)
def _print(depth: float, cell: float = 0.5) -> tuple[PlannedPath, keepout.Index]:
    """Returns the path on the outside of a print of the skull, and the index of all that is `depth` [mm] below it.

    The outside is that of the CT skull, smoothed by 1 mm as a print is. The forbidden region is a closed block, whose
    top is the outside moved inwards along its normals.
    """
    x = np.arange(SAGITTAL_X - 20.0, SAGITTAL_X + 20.01, cell)
    y = np.arange(PATH_BEGINS - 15.0, PATH_BEGINS + PATH_LENGTH + 15.01, cell)
    grid_x, grid_y = np.meshgrid(x, y, indexing="ij")
    z = gaussian_filter(outer_surface(real_index("skull"), grid_x, grid_y), 1.0 / cell)
    slope_x, slope_y = np.gradient(z, cell)
    normals = np.stack([-slope_x, -slope_y, np.ones_like(z)], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    inside = np.stack([grid_x, grid_y, z], axis=-1) - depth * normals
    middle = len(x) // 2
    fine = np.arange(PATH_BEGINS, PATH_BEGINS + PATH_LENGTH + 10.0, 0.05)
    path = _path(fine, np.interp(fine, y, z[middle]), 0.05)
    return path, keepout.Index(_block_below(inside))


def printed_skull() -> tuple[PlannedPath, keepout.Index]:
    """Returns the skull that is traced: the path on its outside, and the index of the skull."""
    return _print(0.0)


def phantom() -> tuple[PlannedPath, keepout.Index]:
    """Returns the phantom that is cut: the path on its outside, and the index of the forbidden region.

    The shell is SHELL thick everywhere, and all below it is forbidden. So the depth of a cut below the inside of the
    shell is the penetration depth of Li et al.
    """
    return _print(SHELL)


def _block_below(top: Array) -> keepout.Mesh:
    """Returns a closed mesh below a grid of points (m, n, 3), down to 10 mm below the lowest point."""
    m, n, _ = top.shape
    bottom = top.copy()
    bottom[..., 2] = top[..., 2].min() - 10.0
    number = np.arange(m * n).reshape(m, n)
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    faces = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3)
    below = faces[:, ::-1] + m * n
    rim = np.concatenate([number[:, 0], number[-1, 1:], number[-2::-1, -1], number[0, -2:0:-1]])
    after = np.roll(rim, -1)
    walls = np.concatenate(
        [np.stack([rim, rim + m * n, after + m * n], 1), np.stack([rim, after + m * n, after], 1)]
    )
    vertices = np.concatenate([top.reshape(-1, 3), bottom.reshape(-1, 3)])
    return keepout.Mesh(vertices, np.concatenate([faces, below, walls]))
