# SPDX-License-Identifier: BSD-3-Clause
"""On which side of a closed mesh the places of a lattice are: what a grid of distances needs.

A vertical line from below to a point enters and leaves the solid; the turns are counted with their
sense, so that parts which overlap stay solid. Nothing is decided by a tolerance: a line through an
edge or a vertex is moved aside by less than any number, the same way for all triangles
(Edelsbrunner and Muecke, "Simulation of simplicity", 1990). An open mesh has no sides.
"""
from __future__ import annotations

from collections.abc import Iterator

import keepout
import numpy as np
from numpy.typing import NDArray

from .experiment import Array
Numbers = NDArray[np.int64]

#: So many pairs of a line and a triangle are looked at together: some hundred MB.
PAIRS_AT_ONCE = 1_000_000


def lattice_is_solid(
    mesh: keepout.Mesh, low: Array, cell: float, shape: tuple[int, int, int]
) -> NDArray[np.bool_]:
    """Which of the places low + cell (i, j, k) are in the solid of a closed mesh: (nx, ny, nz)."""
    vertices, corners = mesh.vertices, mesh.triangles.astype(np.int64)
    columns = np.indices(shape[:2]).reshape(2, -1).T * cell + low[:2]
    # The columns that may pass through each triangle: those of its box, with some room for rounding.
    flat = (vertices[corners][:, :, :2] - low[:2]) / cell
    first = np.clip(np.ceil(flat.min(axis=1) - 1e-6), 0, shape[:2]).astype(np.int64)
    many = np.clip(np.floor(flat.max(axis=1) + 1e-6) + 1, first, shape[:2]).astype(np.int64) - first
    found = []
    for part in _parts(many.prod(axis=1)):
        each = many[part].prod(axis=1)
        which = np.repeat(np.arange(part.start, part.stop), each)
        across = np.stack(np.divmod(_counted_up(each), many[which, 1]), axis=1)
        line = (first[which] + across) @ [shape[1], 1]
        found.append(_crossings_of_pairs(vertices, corners[which], line, columns))
    line, height, turn = (np.concatenate(column) for column in zip(*found))
    level = np.clip(np.floor((height - low[2]) / cell) + 1, 0, shape[2]).astype(np.int64)
    order = np.argsort(line, kind="stable")
    line, level, turn = line[order], level[order], turn[order]
    # Of a mesh whose normals point inwards, as of an airway in which the tool is to stay, all that is outside is solid.
    outside = int(mesh.inspect().inside_out)
    solid = np.empty(shape, dtype=bool)
    plane = shape[1] * (shape[2] + 1)  # of one i; the last level is above all places
    edges = np.searchsorted(line, np.arange(shape[0] + 1) * shape[1])
    for i in range(shape[0]):
        part = slice(edges[i], edges[i + 1])
        place = (line[part] - i * shape[1]) * (shape[2] + 1) + level[part]
        change = np.bincount(place, turn[part], plane).reshape(shape[1], -1)[:, :-1]
        solid[i] = np.cumsum(change, axis=1) + outside > 0.5
    return solid


def _crossings_of_pairs(
    vertices: Array, triangle: Numbers, line: Numbers, lines: Array
) -> tuple[Numbers, Array, Numbers]:
    """Of each line with the triangle beside it, those that cross."""
    place = lines[line]
    sides, areas = zip(*(
        _side(vertices, triangle[:, (i + 1) % 3], triangle[:, (i + 2) % 3], place)
        for i in range(3)
    ))
    crossed = (sides[0] == sides[1]) & (sides[1] == sides[2]) & (sides[0] != 0)
    weights = np.array([np.abs(area[crossed]) for area in areas])
    total = weights.sum(axis=0)
    weights = np.where(total > 0.0, weights, 1.0) / np.where(total > 0.0, total, 3.0)
    height = np.einsum("ij,ji->j", weights, vertices[triangle[crossed], 2])
    return line[crossed], height, -sides[0][crossed]


def _side(vertices: Array, start: Numbers, end: Numbers, place: Array) -> tuple[Numbers, Array]:
    """+1 where a place is left of an edge, -1 right of it, and twice the area that they span.

    Computed of each edge in one direction only, so that both its triangles get opposite answers;
    on the edge itself of the place moved by (e, e^2), for an e that is smaller than any number.
    """
    forward = np.where(start < end, 1, -1)
    a, b = vertices[np.minimum(start, end), :2], vertices[np.maximum(start, end), :2]
    along, to = b - a, place - a
    area = along[:, 0] * to[:, 1] - along[:, 1] * to[:, 0]
    side = np.sign(area)
    side = np.where(side == 0.0, -np.sign(along[:, 1]), side)
    side = np.where(side == 0.0, np.sign(along[:, 0]), side)
    return forward * side.astype(np.int64), area


def _counted_up(counts: Numbers) -> Numbers:
    """0, 1, ... counts[0] - 1, 0, 1, ... counts[1] - 1, and so on."""
    total = int(counts.sum())
    return np.arange(total) - np.repeat(np.cumsum(counts) - counts, counts)


def _parts(counts: Numbers) -> Iterator[slice]:
    """Consecutive parts whose counts add up to PAIRS_AT_ONCE, or to one entry that has more."""
    total = np.cumsum(counts)
    begin = 0
    while begin < len(counts):
        done = int(total[begin - 1]) if begin else 0
        end = max(begin + 1, int(np.searchsorted(total, done + PAIRS_AT_ONCE, "right")))
        yield slice(begin, end)
        begin = end
