# SPDX-License-Identifier: BSD-3-Clause
"""How steps end, what batches write to, and what lists of parts hold."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray


class Part(NamedTuple):
    """An index, an activation rule or a solver that a motion constraint can be made of."""

    name: str
    description: str


class Option(NamedTuple):
    """An option of MotionConstraint or InstrumentGuard."""

    name: str
    type: str  # as in a stub
    default: float | int | bool | str
    unit: str  # empty if it has none
    range: str  # the values that it may have, in words
    choices: tuple[str, ...]  # the names that it may have; empty unless it has some
    description: str
    is_changeable: bool  # by set_options
    command: str  # its name for the keepout command, without "--"; empty if it has none


class Status(IntEnum):
    """How a step ended. The first five come with a motion, which may be carried out and may be
    zero; the others with zero motion."""

    free = 0  # no plane holds the motion back
    limited = 1  # the motion is the best one that the planes allow
    recovering = 2  # the tip was too close or inside: the motion leads it out
    truncated = 3  # only a shorter motion could be proved
    degraded = 4  # a mesh approaches too fast to maintain the certified clearance
    infeasible = 5  # the constraints contradict each other
    ill_posed = 6  # the Jacobian lacks full column rank and there is no damping
    invalid_input = 7  # a number is not finite or out of range
    beyond_reach = 8  # the motion asked for is longer than the motion sphere's radius
    over_capacity = 9  # more triangles, planes, rows or joints than the capacity holds
    unsolved = 10  # the search ended without a motion that could be proved
    inside = 11  # the tip or a body is on the forbidden side, and is not led out
    touching = 12  # on the surface: the free side is unknown
    margin_too_small = 13  # the margin or band is lost in the rounding of lengths this large
    mesh_changed = 14  # the index was refit to another mesh, which is not followed yet
    out_of_budget = 15  # the work budget of the cycle ended before a motion was proved
    unsupported = 16  # the rule cannot answer this query

    # Names before version 0.3.
    fallback = truncated
    yielding = degraded

    def __str__(self) -> str:
        return self.name

    def __format__(self, spec: str) -> str:
        """The name; a number where a type of number is asked for, as in f"{status:d}"."""
        return format(int(self), spec) if spec and spec[-1] in "bcdoxXn" else format(self.name, spec)

    @property
    def ok(self) -> bool:
        """Whether a motion comes with it, which may be carried out."""
        return self <= Status.degraded

    def reason_for(self, subject: str) -> str:
        """Returns one line on what happened to a subject and what to do about it. `subject`: 'tip',
        'instrument' or 'polytope'."""
        from . import _core  # which imports this file first

        return _core._status_reason(self, subject)


class _Batch:
    """What the results of all batches have."""

    status: NDArray[np.uint8]

    @property
    def ok(self) -> NDArray[np.bool_]:
        """In the shape of `status`: whether the motion may be carried out."""
        return self.status <= Status.degraded

    def counts(self) -> dict[Status, int]:
        """How many steps ended with each status."""
        values, counts = np.unique(self.status, return_counts=True)
        return {Status(int(v)): int(n) for v, n in zip(values, counts)}

    def __len__(self) -> int:
        return len(self.status)

    def __repr__(self) -> str:
        counted = ", ".join(f"{status.name}: {n}" for status, n in self.counts().items())
        items = "loops" if self.status.ndim == 2 else "motions" if type(self) is Proofs else "poses"
        return f"<keepout.{type(self).__name__} of {len(self)} {items}: {counted or 'none'}>"


@dataclass(frozen=True, eq=False, repr=False)
class Steps(_Batch):
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


@dataclass(frozen=True, eq=False, repr=False)
class Simulation(_Batch):
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


@dataclass(frozen=True, eq=False, repr=False)
class Proofs(_Batch):
    """How much of each of m motions of an instrument is certified."""

    status: NDArray[np.uint8]  # (m,): of Status, as numbers
    fraction: NDArray[np.float64]  # (m,): proven is a motion from its start to here; 1 if all of it is
    distance: NDArray[np.float64]  # (m,): of the body nearest as it starts [length]; NaN if unknown

    @property
    def is_clear(self) -> NDArray[np.bool_]:
        """(m,): whether the whole margin, less its band, is kept on all of a motion."""
        return (self.status == Status.free) & (self.fraction == 1.0)


def room_for(
    kind: Any, size: tuple[int, ...], out: Any, inputs: tuple[NDArray[Any], ...]
) -> tuple[Any, ...]:
    """`out`, or a new result of that kind and size when it is None, and its three arrays. Raises
    Error unless each is of its type and shape, writeable, without gaps, and shares no memory with
    another or with an input."""
    from . import _core

    if out is None:
        out = kind.empty(*size)
    if kind is Steps:
        points = "motion", (*size, 3)
    else:
        points = "tips", (size[0], size[1] + 1, 3)
    taken = list(inputs)
    columns = (*points, "float64"), ("status", size, "uint8"), ("planes", size, "uint32")
    for name, shape, dtype in columns:
        array = getattr(out, name, None)
        expected = f"an array of {dtype} of shape {shape}"
        if not isinstance(array, np.ndarray):
            got = type(array).__name__
        elif array.dtype != dtype:
            got = f"dtype {array.dtype}"
        elif array.shape != shape:
            got = f"shape {array.shape}"
        elif not (array.flags.c_contiguous and array.flags.aligned):
            expected = "an array without gaps, row by row (C-contiguous)"
            got = "one with strides"
        elif not array.flags.writeable:
            expected, got = "an array to write to", "a read-only one"
        elif any(np.may_share_memory(array, other) for other in taken):
            expected = "memory of its own"
            got = "an array that shares it with another or an input"
        else:
            taken.append(array)
            continue
        raise _core.Error(f"out.{name}: expected {expected}, got {got}")
    return out, *taken[len(inputs) :]
