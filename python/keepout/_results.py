# SPDX-FileCopyrightText: 2026 the keepout authors
# SPDX-License-Identifier: BSD-3-Clause
"""What batches write to, and what lists of parts hold."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._status import Status


class Part(NamedTuple):
    """An index, an activation rule or a solver that a motion constraint can be made of."""

    name: str
    description: str


def _counts(status: NDArray[np.uint8]) -> dict[Status, int]:
    values, counts = np.unique(status, return_counts=True)
    return {Status(int(v)): int(n) for v, n in zip(values, counts)}


@dataclass(frozen=True, eq=False, repr=False)
class Steps:
    """What the steps of n poses came to. Give one as `out` and a batch writes to its arrays: make it
    with Steps.empty(n), or of arrays of your own, which must be C-contiguous and of these types."""

    motion: NDArray[np.float64]  # (n, 3): of the tip; zero unless ok [length]
    status: NDArray[np.uint8]  # (n,): of Status, as numbers
    planes: NDArray[np.uint32]  # (n,): how many planes were posed to the solver

    @classmethod
    def empty(cls, poses: int) -> Steps:
        """Room for that many poses."""
        return cls(
            np.zeros((poses, 3)),
            np.full(poses, Status.invalid_input, np.uint8),
            np.zeros(poses, np.uint32),
        )

    @property
    def ok(self) -> NDArray[np.bool_]:
        """(n,): whether the motion may be carried out."""
        return self.status <= Status.fallback

    def counts(self) -> dict[Status, int]:
        """How many steps ended with each status."""
        return _counts(self.status)

    def __len__(self) -> int:
        return len(self.status)

    def __repr__(self) -> str:
        counted = ", ".join(f"{status.name}: {n}" for status, n in self.counts().items())
        return f"<keepout.Steps of {len(self)} poses: {counted or 'none'}>"


@dataclass(frozen=True, eq=False, repr=False)
class Simulation:
    """Where the tips of m closed loops went. May be given as `out`, as Steps may."""

    tips: NDArray[np.float64]  # (m, cycles + 1, 3): from the start to after the last cycle [length]
    status: NDArray[np.uint8]  # (m, cycles): of Status, as numbers
    planes: NDArray[np.uint32]  # (m, cycles): how many planes were posed to the solver

    @classmethod
    def empty(cls, loops: int, cycles: int) -> Simulation:
        """Room for that many loops of that many cycles."""
        return cls(
            np.zeros((loops, cycles + 1, 3)),
            np.full((loops, cycles), Status.invalid_input, np.uint8),
            np.zeros((loops, cycles), np.uint32),
        )

    @property
    def ok(self) -> NDArray[np.bool_]:
        """(m, cycles): whether the tip could move as the step says."""
        return self.status <= Status.fallback

    def counts(self) -> dict[Status, int]:
        """How many steps ended with each status."""
        return _counts(self.status)

    def __len__(self) -> int:
        return len(self.status)

    def __repr__(self) -> str:
        counted = ", ".join(f"{status.name}: {n}" for status, n in self.counts().items())
        return f"<keepout.Simulation of {len(self)} loops: {counted or 'none'}>"
