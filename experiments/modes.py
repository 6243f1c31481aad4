# SPDX-License-Identifier: BSD-3-Clause
"""The modes to compare, by name. To compare a rule of your own, add it to `_rules`."""
from __future__ import annotations

from collections.abc import Callable
from functools import partial

import keepout

from .rules import native
from .rules.rule import Rule, Task

#: No fixture: the tip follows the hand.
NO_FIXTURE = "none"

_rules: dict[str, Callable[[Task, keepout.Index], Rule]] = {
    "all_faces": partial(native.keepout_rule, activation="all_faces"),
    "paper": partial(native.keepout_rule, activation="paper"),
    "certified": partial(native.keepout_rule, activation="certified"),
    "closest_points_2007": partial(native.closest_points, obstacles="minima"),
    "vector_field": partial(native.closest_points, obstacles="nearest"),
    "distance_field": partial(native.distance_field, cell=0.25),
    "fcl_slide": partial(native.slide, library="continuous_collision"),
    "bullet_slide": partial(native.slide, library="convex_sweep"),
}

#: All fixtures, in the order of tables and figures.
FIXTURES = tuple(_rules)
MODES = (NO_FIXTURE, *FIXTURES)


def make_rule(mode: str, task: Task, index: keepout.Index) -> Rule | None:
    """Returns the rule of a mode for one trial; None without a fixture. Raises KeyError for an unknown mode."""
    return None if mode == NO_FIXTURE else _rules[mode](task, index)
