# SPDX-FileCopyrightText: 2026 the keepout authors
# SPDX-License-Identifier: BSD-3-Clause
"""How steps end."""

from enum import IntEnum


class Status(IntEnum):
    """How a step ended. The first four come with a motion, which may be carried out and may be
    zero; the others with zero motion."""

    free = 0  # no plane holds the motion back
    limited = 1  # the motion is the best one that the planes allow
    recovering = 2  # the tip was too close or inside: the motion leads it out
    fallback = 3  # only a shorter motion could be proven, within the budget of work
    infeasible = 4  # no motion satisfies all planes: the tip is too close on several sides
    ill_posed = 5  # the Jacobian lacks full column rank and there is no damping
    invalid_input = 6  # a number is not finite or out of range
    beyond_reach = 7  # the motion asked for, or solved, is longer than the motion sphere's radius
    over_capacity = 8  # more triangles, planes or variables than room was made for
    unsolved = 9  # the solver gave up, or its answer does not satisfy the planes
    inside = 10  # the tip is on the forbidden side, and joints or rows are in the way out
    touching = 11  # the tip is on the surface, and which side is free cannot be told
    margin_too_small = 12  # the margin is lost in the rounding of lengths this large

    def __str__(self) -> str:
        return self.name

    def __format__(self, spec: str) -> str:
        """The name; a number where a type of number is asked for, as in f"{status:d}"."""
        return format(int(self), spec) if spec and spec[-1] in "bcdoxXn" else format(self.name, spec)

    @property
    def ok(self) -> bool:
        """Whether a motion comes with it, which may be carried out."""
        return self <= Status.fallback

    @property
    def reason(self) -> str:
        """One line on what happened and what to do about it."""
        from . import _core  # which imports this file first

        return _core.status_reason(self)
