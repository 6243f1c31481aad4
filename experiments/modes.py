# SPDX-License-Identifier: BSD-3-Clause
"""The modes to compare, by name. To compare a rule of your own, add it to `_rules`."""
from __future__ import annotations

from collections.abc import Callable
from functools import partial

import keepout

from .rules.closest_points_2007 import ClosestPoints2007
from .rules.collision_library import StopAtContact
from .rules.keepout_rules import KeepoutRule
from .rules.rule import Rule, Task
from .rules.signed_distance_field import SignedDistanceField
from .rules.vector_field_inequality import VectorFieldInequality

#: No fixture: the tip follows the hand.
NO_FIXTURE = "none"

_rules: dict[str, Callable[[Task, keepout.Index], Rule]] = {
    "all_faces": partial(KeepoutRule, activation="all_faces"),
    "paper": partial(KeepoutRule, activation="paper"),
    "certified": partial(KeepoutRule, activation="certified"),
    "closest_points_2007": ClosestPoints2007,
    "vector_field": VectorFieldInequality,
    "sdf_0.25": partial(SignedDistanceField, cell=0.25),
    "sdf_0.5": partial(SignedDistanceField, cell=0.5),
    "sdf_1": partial(SignedDistanceField, cell=1.0),
    "fcl_continuous": partial(StopAtContact, library="continuous_collision"),
    "bullet_sweep": partial(StopAtContact, library="convex_sweep"),
}

#: All fixtures, in the order of tables and figures.
FIXTURES = tuple(_rules)
MODES = (NO_FIXTURE, *FIXTURES)


def make_rule(mode: str, task: Task, index: keepout.Index) -> Rule | None:
    """Returns the rule of a mode for one trial; None without a fixture. Raises KeyError for an unknown mode."""
    return None if mode == NO_FIXTURE else _rules[mode](task, index)
