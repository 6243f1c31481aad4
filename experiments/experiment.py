# SPDX-License-Identifier: BSD-3-Clause
"""What an experiment is: pieces of work that make rows of a table, and what is found in the rows.

A module is an experiment if it has

    NAME = "e3_path_tracing"                     # of its files and on the command line
    TITLE = "E3 Path tracing (section V-A)"
    def units(scale: Scale) -> list[Unit]        # the pieces of work
    def run(unit: Unit) -> list[Row]             # of one piece, in a process of its own
    def findings(rows: list[Row], scale: Scale) -> Findings   # of all rows

`run` depends on nothing but the unit: the same unit gives the same rows, to the last digit, but for
members whose names begin with `measured_`, which are times. Lengths are in mm, times in s, forces in N.
"""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: A row of an experiment's table: names and values, which are text, numbers, true or false, or None.
Row = dict[str, Any]


@dataclass(frozen=True)
class Scale:
    """How much is done. `full` takes hours, and not minutes; `seed` is that of all random numbers."""

    full: bool = False
    seed: int = 1


@dataclass(frozen=True)
class Unit:
    """A piece of work of some seconds or minutes, which is kept once it is done.

    `name` tells it from the others of its experiment, and is part of a file's name: letters, digits,
    '-', '_' and '.'. `settings` is all that `run` is told. A unit that measures times is `alone`:
    nothing else runs meanwhile.
    """

    name: str
    settings: dict[str, Any]
    alone: bool = False


@dataclass(frozen=True)
class Claim:
    """A number of the paper beside ours. Each text is short: a number with its unit and spread."""

    about: str  # such as "penetration depth, fixture (V-B)"
    paper: str  # what the paper prints; "-" where it prints nothing
    reproduction: str  # what its rule does here
    certified: str  # what keepout does
    best: str  # which mode is best here
    sure: str  # how sure that is: p after Holm, effect with its interval
    note: str = ""  # where the reproduction disagrees with the paper: why


@dataclass(frozen=True)
class Table:
    """Rows under headings, as text; `note` says what is to be read out of it."""

    title: str
    columns: list[str]
    rows: list[list[str]]
    note: str = ""


@dataclass(frozen=True)
class Figure:
    """A picture: `svg` is what figures.svg() gives. `name` is that of its file."""

    name: str
    title: str
    caption: str
    svg: str


@dataclass(frozen=True)
class Findings:
    """What an experiment has found. `headline` is one sentence with the numbers that matter."""

    headline: str
    claims: list[Claim] = field(default_factory=list)
    tables: list[Table] = field(default_factory=list)
    figures: list[Figure] = field(default_factory=list)
