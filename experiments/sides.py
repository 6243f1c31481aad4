# SPDX-License-Identifier: BSD-3-Clause
"""Classifies the places of a lattice as inside or outside a closed mesh, for a grid of distances.

A vertical line from below to a point enters and leaves the solid. Each crossing counts with its sign, so that
overlapping parts stay solid. No tolerance decides: a line through an edge or a vertex moves aside by an infinitesimal
amount, the same for all triangles (Edelsbrunner and Muecke, "Simulation of simplicity", 1990). An open mesh has no
inside.
"""
from __future__ import annotations

import keepout
import numpy as np
from numpy.typing import NDArray

from .experiment import Array

Numbers = NDArray[np.int64]


def lattice_is_solid(
    mesh: keepout.Mesh, low: Array, cell: float, shape: tuple[int, int, int]
) -> NDArray[np.bool_]:
    """Returns which of the places low + cell (i, j, k) are in the solid of a closed mesh: (nx, ny, nz)."""
    vertices, corners = mesh.vertices, mesh.triangles.astype(np.int64)
    # The lines that may pass through each triangle: those of its box, widened for rounding.
    flat = (vertices[corners][:, :, :2] - low[:2]) / cell
    first = np.clip(np.ceil(flat.min(axis=1) - 1e-6), 0, shape[:2]).astype(np.int64)
    end = np.clip(np.floor(flat.max(axis=1) + 1e-6) + 1, first, shape[:2]).astype(np.int64)
    # If the normals point inwards, as of an airway with the tool inside, everything outside is solid.
    outside = int(mesh.inspect().inside_out)
    solid = np.empty(shape, dtype=bool)
    for i in range(shape[0]):
        here = np.flatnonzero((first[:, 0] <= i) & (i < end[:, 0]))
        many = end[here, 1] - first[here, 1]
        which = np.repeat(here, many)
        j = np.arange(len(which)) - np.repeat(np.cumsum(many) - many - first[here, 1], many)
        lines = np.stack([np.full(len(j), i), j], axis=1) * cell + low[:2]
        crossed, height, turn = _crossings_of_pairs(vertices, corners[which], lines)
        level = np.clip(np.floor((height - low[2]) / cell) + 1, 0, shape[2]).astype(np.int64)  # the last: above all
        place = j[crossed] * (shape[2] + 1) + level
        change = np.bincount(place, turn, shape[1] * (shape[2] + 1)).reshape(shape[1], -1)[:, :-1]
        solid[i] = np.cumsum(change, axis=1) + outside > 0.5
    return solid


def _crossings_of_pairs(
    vertices: Array, triangle: Numbers, lines: Array
) -> tuple[NDArray[np.bool_], Array, Numbers]:
    """Returns which lines cross the triangle beside them; for those, the height and the sign."""
    sides, areas = zip(*(
        _side(vertices, triangle[:, (i + 1) % 3], triangle[:, (i + 2) % 3], lines)
        for i in range(3)
    ))
    crossed = (sides[0] == sides[1]) & (sides[1] == sides[2]) & (sides[0] != 0)
    weights = np.array([np.abs(area[crossed]) for area in areas])
    total = weights.sum(axis=0)
    weights = np.where(total > 0.0, weights, 1.0) / np.where(total > 0.0, total, 3.0)
    height = np.einsum("ij,ji->j", weights, vertices[triangle[crossed], 2])
    return crossed, height, -sides[0][crossed]


def _side(vertices: Array, start: Numbers, end: Numbers, place: Array) -> tuple[Numbers, Array]:
    """Returns +1 if a place is left of an edge, -1 if right of it, and twice the area that they span.

    Computes each edge in one direction only, so that both its triangles get opposite answers. On the edge itself, the
    place moves by (e, e^2) with an infinitesimal e.
    """
    forward = np.where(start < end, 1, -1)
    a, b = vertices[np.minimum(start, end), :2], vertices[np.maximum(start, end), :2]
    along, to = b - a, place - a
    area = along[:, 0] * to[:, 1] - along[:, 1] * to[:, 0]
    side = np.sign(area)
    side = np.where(side == 0.0, -np.sign(along[:, 1]), side)
    side = np.where(side == 0.0, np.sign(along[:, 0]), side)
    return forward * side.astype(np.int64), area
