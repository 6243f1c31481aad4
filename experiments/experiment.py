# SPDX-License-Identifier: BSD-3-Clause
"""The interface of an experiment: units of work that make the rows of a table, and findings from the rows.

A module is an experiment if it has these members:

`NAME`: the name of its files and on the command line, such as "e3_path_tracing".
`TITLE`: such as "E3 Path tracing (section V-A)".
`units(scale: Scale) -> list[Unit]`: returns the units of work.
`run(unit: Unit) -> list[Row]`: returns the rows of one unit, in a process of its own.
`findings(rows: list[Row], scale: Scale) -> Findings`: returns the findings from all rows.

`run` depends on the unit only: the same unit gives identical rows, except for members whose names begin with
`measured_`, which are times. Lengths are in mm, times in s, forces in N.
"""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


#: A row of an experiment's table: names and values, which are text, numbers, booleans, lists or None.
Row = dict[str, Any]


@dataclass(frozen=True)
class Scale:
    """The extent of a run. `full` takes about an hour instead of minutes; `seed` is for all random numbers."""

    full: bool = False
    seed: int = 1


@dataclass(frozen=True)
class Unit:
    """A unit of work of some seconds or minutes, whose rows are kept.

    `name` is unique in its experiment, and part of a file name: letters, digits, '-', '_' and '.'. `settings` is the
    only input of `run`. A unit that measures times is `alone`: no other unit runs at the same time.
    """

    name: str
    settings: dict[str, Any]
    alone: bool = False


@dataclass(frozen=True)
class Claim:
    """A number of Li et al. (2020) beside ours. Each text is short: a number with its unit and spread."""

    about: str  # such as "penetration depth, fixture (V-B)"
    paper: str  # as Li et al. print it; "-" if they print nothing
    reproduction: str  # the result of their rule here
    certified: str  # the result of keepout
    best: str  # the best mode here
    sure: str  # the evidence: p after Holm, effect with its interval
    note: str = ""  # why the reproduction disagrees with Li et al., if it does


@dataclass(frozen=True)
class Table:
    """Rows under headings, as text; `note` explains how to read them."""

    title: str
    columns: list[str]
    rows: list[list[str]]
    note: str = ""


@dataclass(frozen=True)
class Figure:
    """A figure: `svg` is the result of figures.svg(), `name` the name of its file."""

    name: str
    title: str
    caption: str
    svg: str


@dataclass(frozen=True)
class Findings:
    """The findings of an experiment. `headline` is one sentence with the most important numbers."""

    headline: str
    claims: list[Claim] = field(default_factory=list)
    tables: list[Table] = field(default_factory=list)
    figures: list[Figure] = field(default_factory=list)
