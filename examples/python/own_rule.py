# SPDX-License-Identifier: BSD-3-Clause
"""A rule of your own for the experiments: ./run experiments --rule examples/python/own_rule.py:StopShort"""
import keepout
import numpy as np
from experiments.rules.rule import Task


class StopShort:
    """Shortens a motion to the distance of the nearest triangle: safe, but the tip never slides along a surface.

    Ignores the corridor of E3 and E4.
    """

    def __init__(self, task: Task) -> None:
        self._margin = task.margin
        self._index = keepout.Index(task.mesh)

    def step(self, tip: np.ndarray, desired: np.ndarray) -> np.ndarray:
        free = max(0.0, float(self._index.distances(tip[None], threads=1)[0]) - self._margin)
        length = float(np.linalg.norm(desired))
        return desired * (free / length) if length > free else desired
