# SPDX-License-Identifier: BSD-3-Clause
"""The numbers of the simulation by name, such as `Operator.tremor`, to change some of them."""
from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from typing import TypeVar

T = TypeVar("T")

#: Numbers by name.
Values = Mapping[str, float]


def numbers(of: object) -> dict[str, float]:
    """Returns the finite numbers of a dataclass and of those in it, by name."""
    found: dict[str, float] = {}
    for field in fields(of):
        value = getattr(of, field.name)
        if is_dataclass(value):
            found |= numbers(value)
        elif isinstance(value, float) and math.isfinite(value):
            found[f"{type(of).__name__}.{field.name}"] = value
    return found


def changed(of: T, values: Values) -> T:
    """Returns a dataclass with other values of some of its numbers. Raises KeyError for a name that it has not."""
    if unknown := values.keys() - numbers(of):
        raise KeyError(f"no number is named {', '.join(sorted(unknown))}")
    changes: dict[str, object] = {}
    for field in fields(of):
        value, name = getattr(of, field.name), f"{type(of).__name__}.{field.name}"
        if is_dataclass(value):
            changes[field.name] = changed(value, {n: values[n] for n in values.keys() & numbers(value)})
        elif name in values:
            changes[field.name] = values[name]
    return replace(of, **changes)
