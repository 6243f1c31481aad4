# SPDX-License-Identifier: BSD-3-Clause
"""The numbers of the simulation by name, such as `Operator.tremor`, to change one at a time."""
from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from typing import TypeVar

T = TypeVar("T")


def names(of: object) -> list[str]:
    """Returns the names of the finite numbers other than 0 of a dataclass and of those in it."""
    found = []
    for field in fields(of):
        value = getattr(of, field.name)
        if is_dataclass(value):
            found += names(value)
        elif isinstance(value, float) and value != 0.0 and math.isfinite(value):
            found.append(f"{type(of).__name__}.{field.name}")
    return found


def scaled(of: T, factors: Mapping[str, float]) -> T:
    """Returns a dataclass with some of its numbers times a factor, by name; also in the dataclasses in it."""
    changes: dict[str, object] = {}
    for field in fields(of):
        value, factor = getattr(of, field.name), factors.get(f"{type(of).__name__}.{field.name}")
        if is_dataclass(value):
            changes[field.name] = scaled(value, factors)
        elif factor is not None:
            changes[field.name] = value * factor
    return replace(of, **changes)
