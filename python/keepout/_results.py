# SPDX-License-Identifier: BSD-3-Clause
"""Statuses, the results of batches, and the items of lists of parts and options."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray


class Part(NamedTuple):
    """An index, an activation rule or a solver: a part that a motion constraint is made of."""

    name: str
    description: str


class Option(NamedTuple):
    """An option of MotionConstraint or InstrumentGuard."""

    name: str
    type: str  # as in a stub
    default: float | int | bool | str
    unit: str  # empty if it has none
    range: str  # the permitted values, in words
    choices: tuple[str, ...]  # the permitted names; empty unless the option is a choice
    description: str
    is_changeable: bool  # True if set_options can change it
    command: str  # its name for the keepout command, without "--"; empty if it has none


class Status(IntEnum):
    """The outcome of a step. The first five come with a motion that may be executed; it may be
    zero. All others come with zero motion."""

    free = 0  # no plane limits the motion
    limited = 1  # the motion is the best one that the planes allow
    recovering = 2  # the tip was too close or inside: the motion retreats or escapes
    truncated = 3  # only a shorter motion could be proved
    degraded = 4  # a mesh approaches too fast to maintain the certified clearance
    infeasible = 5  # the constraints contradict each other
    ill_posed = 6  # the Jacobian lacks full column rank and there is no damping
    invalid_input = 7  # a number is not finite or out of range
    beyond_reach = 8  # the desired motion is longer than the radius of the motion sphere
    over_capacity = 9  # more triangles, planes, rows or joints than the capacity holds
    unsolved = 10  # the search ended without a motion that could be proved
    inside = 11  # the tip or a body is on the forbidden side, and no escape is made
    touching = 12  # on the surface: the free side is unknown
    margin_too_small = 13  # the margin or band is lost in the rounding of lengths this large
    mesh_changed = 14  # the index was refit to another mesh; call follow() first
    out_of_budget = 15  # the work budget of the cycle ended before a motion was proved
    unsupported = 16  # the rule cannot answer this query
    unconfirmed = 17  # the monitor did not confirm the motion

    # Names before version 0.3.
    fallback = truncated
    yielding = degraded

    def __str__(self) -> str:
        return self.name

    def __format__(self, spec: str) -> str:
        """Returns the name, or the number for a numeric format such as f"{status:d}"."""
        return format(int(self), spec) if spec and spec[-1] in "bcdoxXn" else format(self.name, spec)

    @property
    def ok(self) -> bool:
        """True if the step has a motion that may be executed."""
        return self <= Status.degraded

    def reason_for(self, subject: str) -> str:
        """Returns one line on what happened to a subject and what to do about it. subject: 'tip',
        'instrument' or 'polytope'."""
        from . import _core  # which imports this file

        return _core._status_reason(self, subject)


class _Batch:
    """The members that the results of all batches have."""

    status: NDArray[np.uint8]

    @property
    def ok(self) -> NDArray[np.bool_]:
        """True where the motion may be executed, in the shape of `status`."""
        return self.status <= Status.degraded

    def counts(self) -> dict[Status, int]:
        """Returns how many steps ended with each status."""
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
    """The results of the steps of n poses. A batch writes into the arrays of a Steps given as
    `out`. Make it with Steps.empty(n), or from your own arrays: C-contiguous, with these types."""

    motion: NDArray[np.float64]  # (n, 3): of the tip; zero unless ok [length]
    status: NDArray[np.uint8]  # (n,): numbers of Status
    planes: NDArray[np.uint32]  # (n,): the number of planes that the solver received

    @classmethod
    def empty(cls, poses: int) -> Steps:
        """Returns a Steps with memory for that many poses."""
        return cls(
            np.zeros((poses, 3)),
            np.full(poses, Status.invalid_input, np.uint8),
            np.zeros(poses, np.uint32),
        )


@dataclass(frozen=True, eq=False, repr=False)
class Simulation(_Batch):
    """The tip positions of m closed loops. May be given as `out`, like Steps."""

    tips: NDArray[np.float64]  # (m, cycles + 1, 3): the start, and the tip after each cycle
                               # [length]
    status: NDArray[np.uint8]  # (m, cycles): numbers of Status
    planes: NDArray[np.uint32]  # (m, cycles): the number of planes that the solver received

    @classmethod
    def empty(cls, loops: int, cycles: int) -> Simulation:
        """Returns a Simulation with memory for that many loops of that many cycles."""
        return cls(
            np.zeros((loops, cycles + 1, 3)),
            np.full((loops, cycles), Status.invalid_input, np.uint8),
            np.zeros((loops, cycles), np.uint32),
        )


@dataclass(frozen=True, eq=False, repr=False)
class Proofs(_Batch):
    """The certified part of each of m motions of an instrument."""

    status: NDArray[np.uint8]  # (m,): numbers of Status
    fraction: NDArray[np.float64]  # (m,): the motion is proved from its start to this fraction
    distance: NDArray[np.float64]  # (m,): of the nearest body at the start; NaN if unknown [length]

    @property
    def share(self) -> NDArray[np.float64]:
        """Deprecated: use fraction."""
        warnings.warn("Proofs.share is now fraction", DeprecationWarning, stacklevel=2)
        return self.fraction

    @property
    def is_clear(self) -> NDArray[np.bool_]:
        """(m,): True where each body maintains margin minus band on the whole motion."""
        return (self.status == Status.free) & (self.fraction == 1.0)


def room_for(
    kind: Any, size: tuple[int, ...], out: Any, inputs: tuple[NDArray[Any], ...]
) -> tuple[Any, ...]:
    """Returns `out`, or without one a new result of that kind and size, and its three arrays.
    Raises Error unless each array has its type and shape, is writeable and C-contiguous, and shares
    no memory with another array or an input."""
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
