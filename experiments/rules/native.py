# SPDX-License-Identifier: BSD-3-Clause
"""The rules of C++. The headers in benchmarks/native/rules describe each of them, with its source.

Rules, pushers and judges of C++ share a `Terrain`: the mesh with its index.
"""
from __future__ import annotations

from functools import lru_cache
from typing import Any

import keepout
import keepout_peers

from .rule import Rule, Task

#: The narrow band of a distance field reaches this many cells beyond the margin, as OpenVDB's does by default.
BAND_CELLS = 3.0

#: Both collision libraries need a ball; for a margin of 0 it has this radius. [mm]
LEAST_RADIUS = 0.001


@lru_cache(maxsize=2)
def terrain_of(mesh: keepout.Mesh) -> Any:
    """Returns the keepout_peers.Terrain of a mesh; made once in a process."""
    return keepout_peers.Terrain(mesh.vertices, mesh.triangles)


@lru_cache(maxsize=4)
def field_of(mesh: keepout.Mesh, cell: float, margin: float) -> Any:
    """Returns the keepout_peers.DistanceField of a mesh, for cells and a margin in mm; shared by trials."""
    return keepout_peers.DistanceField(terrain_of(mesh), cell, margin + BAND_CELLS * cell)


@lru_cache(maxsize=2)
def _model_of(mesh: keepout.Mesh, library: str, radius: float) -> Any:
    return getattr(keepout_peers, library)(terrain_of(mesh), radius)


def _native(task: Task) -> Any:
    native = keepout_peers.Task(terrain_of(task.mesh), task.margin, task.radius)
    if task.corridor:
        native.set_corridor(task.corridor.point, task.corridor.normal, task.corridor.half_width)
    return native


def keepout_rule(task: Task, *, activation: str) -> Rule:
    """Returns keepout's own rule with an activation rule: all faces, that of Li et al. (2020), or certified."""
    rule: Rule = keepout_peers.keepout_rule(_native(task), activation)
    return rule


def closest_points(task: Task, *, obstacles: str, gain: float = 1.0) -> Rule:
    """Returns the rule with a plane for closest points of the mesh: `nearest`, `minima` or `all`."""
    rule: Rule = keepout_peers.closest_point_planes(_native(task), obstacles, gain)
    return rule


def distance_field(task: Task, *, cell: float, use: str = "cut") -> Rule:
    """Returns the rule of a distance field with cells in mm: `plane`, `cut` or `sure`."""
    field = field_of(task.mesh, cell, task.margin)
    rule: Rule = keepout_peers.distance_field_rule(_native(task), field, use)
    return rule


def slide(task: Task, *, library: str) -> Rule:
    """Returns the rule that moves until contact and slides; `library`: the function that makes the Sweep."""
    model = _model_of(task.mesh, library, max(task.margin, LEAST_RADIUS))
    rule: Rule = keepout_peers.slide(_native(task), model)
    return rule
