# SPDX-License-Identifier: BSD-3-Clause
"""The modes to compare, by name, and the rule of each.

A rule is imported when a trial needs it, so that `runner` knows the sources of each mode apart. For a rule of your
own, no line here is necessary: `--rule FILE:CLASS`.
"""
from __future__ import annotations

import importlib
import importlib.util
import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import keepout_peers

from .rules.rule import Rule, Task

#: No fixture: the tip follows the hand.
NO_FIXTURE = "none"

#: The modes that all others are compared with; they are always part of a run.
REFERENCES = (NO_FIXTURE, "paper", "certified")

#: The variables by which `--modes` and `--rule` reach this process and its workers.
CHOSEN, OWN_RULE = "KEEPOUT_MODES", "KEEPOUT_RULE"


@dataclass(frozen=True)
class Source:
    """The place of the rule of a mode: a class, or a function that makes the rule, and its options."""

    module: str  # of experiments.rules, or the path of a file that ends in .py
    name: str  # of the class or function
    options: dict[str, Any] = field(default_factory=dict)

    @property
    def is_built(self) -> bool:
        """False if the rule needs a library that was not found when keepout_peers was built."""
        return hasattr(keepout_peers, self.options.get("library", "keepout_rule"))

    def make(self, task: Task) -> Rule:
        """Returns the rule for one trial."""
        rule: Rule = getattr(self._imported(), self.name)(task, **self.options)
        return rule

    def _imported(self) -> Any:
        if not self.module.endswith(".py"):
            return importlib.import_module(f".rules.{self.module}", __package__)
        spec = importlib.util.spec_from_file_location(Path(self.module).stem, self.module)
        assert spec is not None and spec.loader is not None, "a path that ends in .py has a loader"
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module


_rules = {
    "all_faces": Source("native", "keepout_rule", {"activation": "all_faces"}),
    "paper": Source("native", "keepout_rule", {"activation": "paper"}),
    "certified": Source("native", "keepout_rule", {"activation": "certified"}),
    "closest_points_2007": Source("native", "closest_points", {"obstacles": "minima"}),
    "vector_field": Source("native", "closest_points", {"obstacles": "nearest"}),
    "distance_field": Source("native", "distance_field", {"cell": 0.25}),
    "fcl_slide": Source("native", "slide", {"library": "continuous_collision"}),
    "bullet_slide": Source("native", "slide", {"library": "convex_sweep"}),
}
for _mode in [mode for mode, source in _rules.items() if not source.is_built]:
    del _rules[_mode]
#: All fixtures of this package as it is built, whether a run has them or not.
BUILT_IN = tuple(_rules)

_file, _, _class = os.environ.get(OWN_RULE, "").rpartition(":")
if _class:
    _rules[_class] = Source(_file, _class)
_names = os.environ.get(CHOSEN, "").split(",")

#: All fixtures of this run, in the order of tables and figures.
FIXTURES = tuple(mode for mode in _rules if _names == [""] or mode in (*REFERENCES, *_names, _class))
MODES = (NO_FIXTURE, *FIXTURES)


def source(mode: str) -> Source | None:
    """Returns where the rule of a mode is; None without a fixture. Raises KeyError for an unknown mode."""
    return None if mode == NO_FIXTURE else _rules[mode]


def make_rule(mode: str, task: Task) -> Rule | None:
    """Returns the rule of a mode for one trial; None without a fixture. Raises KeyError for an unknown mode."""
    found = source(mode)
    return None if found is None else found.make(task)
